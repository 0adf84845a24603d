// SPDX-License-Identifier: BSD-3-Clause
// An output pin as the outside sees it. It counts its edges and the clocks of its high level, so that a plant that
// looks once a millisecond misses no step and knows the duty.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "device/clock.hpp"

namespace unitylink::device {

class OutputPin {
 public:
  using Watcher = std::function<void(bool level, Clock state)>;

  void change(bool level, Clock state) {
    if (level == level_) {
      return;
    }
    if (level) {
      ++rises_;
      steps_ += direction_ == nullptr || direction_->level_ ? 1 : -1;
    } else {
      high_clocks_ += state - changed_;
    }
    level_ = level;
    changed_ = state;
    for (const Watcher& watcher : watchers_) {
      watcher(level, state);
    }
  }

  [[nodiscard]] bool level() const noexcept { return level_; }
  [[nodiscard]] std::uint64_t rises() const noexcept { return rises_; }
  // Rises while the direction pin is high, less those while it is low.
  [[nodiscard]] std::int64_t steps() const noexcept { return steps_; }
  [[nodiscard]] std::uint64_t high_clocks(Clock state) const noexcept {
    return high_clocks_ + (level_ ? state - changed_ : 0);
  }

  [[nodiscard]] bool is_counted() const noexcept { return direction_ != nullptr; }
  void count_by(const OutputPin* direction) noexcept { direction_ = direction; }
  // Several may watch a pin. An empty watcher sends all away. One that is not `prompt` is told of a change when the
  // component is advanced for another reason, and pins may be told one after the other.
  void watch(Watcher watcher, bool prompt = true) {
    if (watcher) {
      watchers_.push_back(std::move(watcher));
      is_watched_ = is_watched_ || prompt;
    } else {
      watchers_.clear();
      is_watched_ = false;
    }
  }
  [[nodiscard]] bool is_watched() const noexcept { return is_watched_; }

 private:
  bool level_ = false;
  Clock changed_ = 0;
  std::uint64_t rises_ = 0;
  std::uint64_t high_clocks_ = 0;
  std::int64_t steps_ = 0;
  const OutputPin* direction_ = nullptr;
  std::vector<Watcher> watchers_;
  bool is_watched_ = false;  // by one that is prompt
};

}  // namespace unitylink::device
