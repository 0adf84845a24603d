// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/lockstep.hpp"

#include <algorithm>

#include "layer0_driver/polling.hpp"
#include "layer0_driver/robot_time.hpp"

namespace unitylink {
namespace {

// If members stay due for so many times and do nothing, because a client takes no bytes for example, time goes on.
constexpr unsigned still_most = 1'000;
constexpr std::uint64_t stuck_step_ns = 1'000;
// So often it looks for news from other threads while nothing happens: one of them may close the link.
constexpr std::uint64_t look_period_ns = 100'000'000;
// While nothing is due at all, only another thread can change this.
constexpr std::uint64_t idle_pause_ns = 1'000'000;

}  // namespace

Lockstep& Lockstep::here() {
  static auto* const lockstep = new Lockstep;  // never deleted, as RobotTime
  return *lockstep;
}

void Lockstep::join(Member& member) {
  const std::scoped_lock lock(mutex_);
  {
    const std::scoped_lock touched_lock(touched_mutex_);
    touched_.reserve(members_.size() + 1);
    members_.push_back(&member);
    dues_.push_back(RobotTime::idle);
    member.seat_ = members_.size() - 1;
  }
  ++changes_;
  touch(member);
}

void Lockstep::leave(Member& member) {
  const std::scoped_lock lock(mutex_);
  if (member.seat_ == no_seat) {
    return;
  }
  {
    const std::scoped_lock touched_lock(touched_mutex_);
    std::erase(touched_, &member);
    dues_.erase(dues_.begin() + static_cast<std::ptrdiff_t>(member.seat_));
    members_.erase(members_.begin() + static_cast<std::ptrdiff_t>(member.seat_));
    for (std::size_t seat = member.seat_; seat < members_.size(); ++seat) {
      members_[seat]->seat_ = seat;  // in the same order, so that each run is the same
    }
    member.seat_ = no_seat;
    member.touched_ = false;
  }
  ++changes_;
}

void Lockstep::touch(Member& member) noexcept {
  const std::scoped_lock lock(touched_mutex_);
  if (member.seat_ != no_seat && !member.touched_) {
    member.touched_ = true;
    touched_.push_back(&member);
    any_touched_ = true;
  }
}

Lockstep::Member* Lockstep::next_touched() noexcept {
  if (!any_touched_) {
    return nullptr;
  }
  const std::scoped_lock lock(touched_mutex_);
  if (touched_.empty()) {
    any_touched_ = false;
    return nullptr;
  }
  Member* const next = touched_.back();
  touched_.pop_back();
  next->touched_ = false;
  return next;
}

void Lockstep::ask(std::size_t seat) noexcept {
  const std::uint64_t changes = changes_;
  Member* const member = members_[seat];
  member->take_in();
  const std::uint64_t due_ns = member->due_ns();
  if (changes == changes_) {
    dues_[seat] = due_ns;
  }
}

void Lockstep::take_in(const Member* self) noexcept {
  while (const Member* const member = next_touched()) {
    if (member != self) {
      ask(member->seat_);
    }
  }
}

// Lets the member work whose work is due first, until another one is due. With none, it is `until_ns`.
void Lockstep::work(std::uint64_t until_ns) noexcept {
  std::size_t first = no_seat;
  std::uint64_t first_ns = until_ns;
  std::uint64_t second_ns = until_ns;
  for (std::size_t seat = 0; seat < dues_.size(); ++seat) {
    if (dues_[seat] < first_ns) {
      second_ns = first_ns;
      first_ns = dues_[seat];
      first = seat;
    } else {
      second_ns = std::min(second_ns, dues_[seat]);
    }
  }
  RobotTime::here().step_to(first_ns);
  if (first == no_seat) {
    return;
  }
  const std::uint64_t changes = changes_;
  members_[first]->work(second_ns);
  if (changes == changes_) {
    ask(first);
  } else {  // a plant has opened or closed boards, perhaps its own
    for (Member* const member : members_) {
      touch(*member);
    }
  }
}

int Lockstep::advance(std::uint64_t until_ns, std::span<pollfd> waiting, Member* self) noexcept {
  const std::scoped_lock lock(mutex_);
  if (self != nullptr) {
    dues_[self->seat_] = RobotTime::idle;
  }
  int ready = 0;
  unsigned still = 0;
  for (;;) {
    take_in(self);
    const std::uint64_t now_ns = RobotTime::here().now_ns();
    ready = self != nullptr && self->has_news() ? 1 : 0;
    ready += waiting.empty() ? 0 : poll_for(waiting, 0);
    if (ready != 0 || now_ns >= until_ns) {
      break;
    }
    if (until_ns == RobotTime::idle &&
        std::ranges::all_of(dues_, [](std::uint64_t due_ns) { return due_ns == RobotTime::idle; })) {
      ready = poll_for(waiting, idle_pause_ns);
      break;
    }
    work(std::min(until_ns, now_ns + std::min(look_period_ns, RobotTime::idle - now_ns)));
    still = RobotTime::here().now_ns() == now_ns ? still + 1 : 0;
    if (still > still_most) {
      RobotTime::here().step_to(std::min(now_ns + stuck_step_ns, until_ns));
    }
  }
  if (self != nullptr) {
    touch(*self);
  }
  return ready;
}

}  // namespace unitylink
