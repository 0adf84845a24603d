// SPDX-License-Identifier: BSD-3-Clause
// A link whose time goes in steps (layer0_driver/lockstep.hpp): whoever waits advances the time of all boards and
// links.
#include <algorithm>
#include <chrono>
#include <thread>

#include "layer0_driver/local_line.hpp"
#include "layer0_driver/polling.hpp"
#include "layer2_message/link.hpp"

namespace unitylink {

// While another link waits, this one reads what comes, repeats what is late, and gives its signs of life.
class Link::Step final : public Lockstep::Member {
 public:
  explicit Step(Link& link) : link_(link) {}

  [[nodiscard]] std::uint64_t due_ns() noexcept override {
    const std::scoped_lock lock(link_.mutex_);
    return link_.leading_ || link_.engine_->ended() ? RobotTime::idle : link_.engine_->next_deadline_ns();
  }

  void take_in() noexcept override {
    Lock lock(link_.mutex_);
    if (!link_.leading_ && !link_.engine_->ended() && link_.line_ == Line::up) {
      link_.lead(lock, 0);
      link_.hand_over();
    }
  }

  void work(std::uint64_t) noexcept override { take_in(); }

  [[nodiscard]] bool has_news() noexcept override {
    const std::scoped_lock lock(link_.mutex_);
    LocalLine* const line = link_.driver_->local_line();
    return link_.woken_ || (line != nullptr &&
                            (line->readable(LocalLine::link) || (link_.blocked_ && line->writable(LocalLine::link))));
  }

 private:
  Link& link_;
};

std::unique_ptr<Lockstep::Member> Link::step_of(Link& link, Driver::TimeSource clock) {
  return clock != &real_ns && RobotTime::here().in_steps() ? std::make_unique<Step>(link) : nullptr;
}

void Link::join_steps() {
  if (step_ != nullptr) {
    Lockstep::here().join(*step_);
    if (LocalLine* const line = driver_->local_line(); line != nullptr) {
      line->listen(LocalLine::link, step_.get());
    }
  }
}

void Link::leave_steps() {
  if (step_ != nullptr) {
    if (LocalLine* const line = driver_->local_line(); line != nullptr) {
      line->listen(LocalLine::link, nullptr);
    }
    Lockstep::here().leave(*step_);
  }
}

// Its deadline may have changed, or it reads no longer for itself.
void Link::touch_steps() noexcept {
  if (step_ != nullptr) {
    Lockstep::here().touch(*step_);
  }
}

// Waits for a descriptor, at most until `until_ns`. The first two are of the line and of wake().
int Link::poll_until(std::uint64_t until_ns, std::span<pollfd> waiting) noexcept {
  const std::uint64_t now = now_ns();
  if (driver_->local_line() != nullptr) {  // then Step::has_news() knows of these two
    waiting = waiting.subspan(waiting[2].fd < 0 ? 3 : 2);
  }
  if (step_ != nullptr && until_ns > now) {
    return Lockstep::here().advance(until_ns, waiting, step_.get());
  }
  if (waiting.empty()) {
    return 0;
  }
  return poll_for(waiting, until_ns == Engine::no_deadline ? for_ever : until_ns - std::min(until_ns, now));
}

Outcome Link::pass(std::uint64_t until_ns) {
  Lock lock(mutex_);
  std::uint64_t now = now_ns();
  for (std::uint64_t look_ns = now + interruption_patience_ns; now < until_ns; now = now_ns()) {
    if (engine_->ended()) {
      return end();
    }
    if (step_ != nullptr) {
      turn(lock, std::min(until_ns, look_ns));
    } else {
      lock.unlock();
      std::this_thread::sleep_for(std::chrono::nanoseconds(std::min(until_ns, look_ns) - now));
      lock.lock();
    }
    if (now_ns() >= look_ns) {
      look_ns = now_ns() + interruption_patience_ns;
      if (interrupted(lock)) {
        return {};
      }
    }
  }
  return {};
}

}  // namespace unitylink
