// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/robot_time.hpp"

#include <algorithm>
#include <chrono>

namespace unitylink {

std::uint64_t real_ns() noexcept {
  return static_cast<std::uint64_t>(
      std::chrono::duration_cast<std::chrono::nanoseconds>(std::chrono::steady_clock::now().time_since_epoch())
          .count());
}

RobotTime& RobotTime::here() {
  // never deleted: the thread of a board may still run when static objects are destroyed
  static auto* const time = new RobotTime;
  return *time;
}

RobotTime::Follower::Follower(RobotTime& time) : time_(time) {
  const std::scoped_lock lock(time_.mutex_);
  time_.followers_.push_back(this);
}

RobotTime::Follower::~Follower() {
  const std::scoped_lock lock(time_.mutex_);
  std::erase(time_.followers_, this);
}

void RobotTime::Follower::due(std::uint64_t robot_ns) noexcept {
  const std::scoped_lock lock(time_.mutex_);
  if (robot_ns != due_ns_) {
    due_ns_ = robot_ns;
    late_since_ns_ = 0;
  }
}

void RobotTime::claim(bool in_steps) {
  const std::scoped_lock lock(mutex_);
  if (boards_ > 0 && in_steps_ != in_steps) {
    throw TimeConflict(in_steps ? "the other virtual boards of this process follow real time, so this one cannot go in "
                                  "steps; close them first, or give them time=lockstep, too"
                                : "the other virtual boards of this process go in steps (time=lockstep), so this one "
                                  "cannot follow real time; close them first, or give this one time=lockstep, too");
  }
  if (boards_ == 0 && in_steps) {
    last_ns_ = stepped_start_ns;
    in_steps_ = true;
  }
  ++boards_;
}

void RobotTime::release(bool in_steps) noexcept {
  const std::scoped_lock lock(mutex_);
  if (--boards_ == 0 && in_steps) {
    in_steps_ = false;
    last_ns_ = slip_ns_ = 0;
  }
}

void RobotTime::step_to(std::uint64_t robot_ns) noexcept {
  const std::scoped_lock lock(mutex_);
  if (in_steps_) {
    last_ns_ = std::max(last_ns_.load(), robot_ns);
  }
}

std::uint64_t RobotTime::now_ns(std::uint64_t real) noexcept {
  if (in_steps_) {
    return last_ns_;
  }
  const std::scoped_lock lock(mutex_);
  if (in_steps_) {
    return last_ns_;
  }
  const std::uint64_t wanted = real - std::min(real, slip_ns_);
  if (wanted <= last_ns_) {  // another thread read the real time later, but came here first
    return last_ns_;
  }
  const std::uint64_t lag_most = followers_.size() > 1 ? lag_together_ns : lag_alone_ns;
  std::uint64_t now = wanted;
  for (Follower* const follower : followers_) {
    if (follower->due_ns_ >= wanted || wanted - follower->due_ns_ <= lag_most) {
      continue;
    }
    if (follower->late_since_ns_ == 0) {
      follower->late_since_ns_ = real;
    }
    if (real < follower->late_since_ns_ + patience_ns) {
      now = std::min(now, follower->due_ns_ + lag_most);
    }
  }
  last_ns_ = std::max(now, last_ns_.load());
  slip_ns_ = real - last_ns_;
  return last_ns_;
}

}  // namespace unitylink
