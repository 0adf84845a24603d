// SPDX-License-Identifier: BSD-3-Clause
// Finds out that all axes rest: after a whole cycle of base periods and ramps everything is as it was. Then it stays so
// until something comes from outside, and the cycles that follow need not be run.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "stepgen_ramp.hpp"

namespace unitylink::device {

class StepgenRest {
 public:
  // What may change in a cycle, beside the time. `flags` are those of the bus, the limits and the latches.
  struct State {
    StepgenMotion motion;
    StepgenRamp ramp;
    StepgenRamp::Words words{};
    std::array<std::uint32_t, 9> flags{};
    bool operator==(const State&) const = default;
  };

  explicit StepgenRest(const StepgenRates& rates, const StepgenMotion& motion)
      : cycle_clocks_(motion.periods().cycle_clocks(periods_of_both_banks * rates.axes)) {}

  [[nodiscard]] bool rests() const noexcept { return rests_; }
  // The clock in which the next look is due.
  [[nodiscard]] Clock due() const noexcept { return due_; }
  // Whole cycles before the state `until`.
  [[nodiscard]] Clock clocks(Clock now, Clock until) const noexcept {
    return (until - now) / cycle_clocks_ * cycle_clocks_;
  }

  // Something has come from outside.
  void disturb(Clock now) noexcept {
    rests_ = compares_ = false;
    due_ = now;
  }
  // An output or an event has changed.
  void show() noexcept { shows_ = true; }

  void look(const State& state, Clock now) {
    if (compares_) {
      before_->motion.pass(cycle_clocks_);
      rests_ = !shows_ && *before_ == state;
    }
    shows_ = false;
    compares_ = !rests_ && state.motion.begins();
    if (compares_) {
      before_ = state;
    }
    due_ = rests_ ? never : now + (compares_ ? cycle_clocks_ : 1);
  }

 private:
  static constexpr std::uint32_t periods_of_both_banks = 128;  // of a ramp, for each bank of velocities

  Clock cycle_clocks_;
  Clock due_ = 0;
  bool rests_ = false, compares_ = false, shows_ = false;
  std::optional<State> before_;
};

}  // namespace unitylink::device
