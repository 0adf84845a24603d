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
// So often the descriptors are looked at while nothing happens: another thread may close the link.
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
  members_.push_back(&member);
  ++changes_;
}

void Lockstep::leave(Member& member) {
  const std::scoped_lock lock(mutex_);
  std::erase(members_, &member);
  ++changes_;
}

void Lockstep::all_take_in(const Member* self) noexcept {
  // a plant may open and close boards: then all are asked again
  for (std::uint64_t seen = changes_ + 1; seen != changes_;) {
    seen = changes_;
    for (std::size_t index = 0; index < members_.size() && seen == changes_; ++index) {
      if (members_[index] != self) {
        members_[index]->take_in();
      }
    }
  }
}

// Lets the member work whose work is due first. Ends when another one is due, when something has gone from one to
// another (true), or at `until_ns`.
bool Lockstep::work(std::uint64_t until_ns, const Member* self) noexcept {
  Member* first = nullptr;
  std::uint64_t first_ns = until_ns;
  std::uint64_t second_ns = until_ns;
  for (Member* const member : members_) {
    const std::uint64_t due_ns = member == self ? RobotTime::idle : member->due_ns();
    if (due_ns < first_ns) {
      second_ns = first_ns;
      first_ns = due_ns;
      first = member;
    } else {
      second_ns = std::min(second_ns, due_ns);
    }
  }
  if (first_ns != RobotTime::idle) {
    RobotTime::here().step_to(first_ns);
  }
  return first != nullptr && first->work(second_ns);
}

bool Lockstep::is_idle(const Member* self) noexcept {
  return std::ranges::all_of(members_,
                             [self](Member* member) { return member == self || member->due_ns() == RobotTime::idle; });
}

int Lockstep::advance(std::uint64_t until_ns, std::span<pollfd> waiting, const Member* self) noexcept {
  const std::scoped_lock lock(mutex_);
  unsigned still = 0;
  for (;;) {
    all_take_in(self);
    std::uint64_t now_ns = RobotTime::here().now_ns();
    if (const int ready = poll_for(waiting, 0); ready != 0 || now_ns >= until_ns) {
      return ready;
    }
    if (until_ns == RobotTime::idle && is_idle(self)) {
      return poll_for(waiting, idle_pause_ns);
    }
    const std::uint64_t look_ns = std::min(until_ns, now_ns + std::min(look_period_ns, RobotTime::idle - now_ns));
    for (bool news = false; !news && now_ns < look_ns;) {
      const std::uint64_t before_ns = now_ns;
      news = work(look_ns, self);
      now_ns = RobotTime::here().now_ns();
      still = now_ns == before_ns ? still + 1 : 0;
      if (still > still_most) {
        RobotTime::here().step_to(std::min(now_ns + stuck_step_ns, until_ns));
      }
    }
  }
}

}  // namespace unitylink
