// SPDX-License-Identifier: BSD-3-Clause
// The model of stepgen_pulse.vhd, and the numbers of stepgen_pkg.vhd.
#pragma once

#include <algorithm>
#include <cstdint>

#include "device/clock.hpp"
#include "device/component/component_configuration.hpp"

namespace unitylink::device {

// What follows from the generics.
struct StepgenRates {
  explicit StepgenRates(const ComponentConfiguration& from)
      : clock_hz(static_cast<std::uint32_t>(from.generic("clock_hz", 50'000'000))),
        axes(static_cast<std::uint32_t>(from.generic("axes", 4))) {
    while ((1u << number_bits) < axes) {
      ++number_bits;
    }
    const std::uint32_t work = 3 + std::max(axes, 3u) + axes;
    while (base_bits > 20 && clock_hz >> base_bits < work) {
      --base_bits;
    }
    short_clocks = clock_hz >> base_bits;
    clearing_clocks = Clock{1} << (number_bits + 4);
  }

  bool operator==(const StepgenRates&) const = default;

  // At least so long, and at least one clock.
  static std::uint32_t clocks_of(std::int64_t time_ns, std::int64_t clock_hz) noexcept {
    const std::int64_t clock_khz = (clock_hz + 999) / 1000;
    const std::int64_t thousands = time_ns / 1000 * clock_khz;
    const std::int64_t rest = thousands % 1000 * 1000 + time_ns % 1000 * clock_khz + 999'999;
    return static_cast<std::uint32_t>(std::max<std::int64_t>(1, thousands / 1000 + rest / 1'000'000));
  }

  std::uint32_t clock_hz;
  std::uint32_t axes;
  std::uint32_t number_bits = 2;
  std::uint32_t base_bits = 22;
  std::uint32_t short_clocks = 0;  // of a base period; some are one longer
  Clock clearing_clocks = 0;       // after a reset

  [[nodiscard]] std::uint32_t phase_bits() const noexcept { return 8 + base_bits; }
};

// The pins STEP and DIR of one axis.
class StepgenPulse {
 public:
  bool operator==(const StepgenPulse&) const = default;

  void configure(const ComponentConfiguration& from) {
    const auto clocks = [&](const char* name) {
      return StepgenRates::clocks_of(from.generic(name, 200), from.generic("clock_hz", 50'000'000));
    };
    length_ = clocks("step_len_ns");
    space_ = clocks("step_space_ns");
    setup_ = clocks("dir_setup_ns");
    hold_ = clocks("dir_hold_ns");
    timer_ = std::max({length_, space_, setup_, hold_}) - 1;
  }

  [[nodiscard]] bool step() const noexcept { return step_; }
  [[nodiscard]] bool direction() const noexcept { return direction_; }
  // Would a step be made in this clock, and if not: because the pulse before has not ended?
  [[nodiscard]] bool takes(bool down) const noexcept { return ready() && down != direction_; }
  [[nodiscard]] bool is_late(bool down) const noexcept {
    return !ready() && state_ == State::resting && down != direction_;
  }
  // Nothing changes by itself.
  [[nodiscard]] bool is_resting() const noexcept { return timer_ == 0 && is_quiet(); }
  // Nothing changes by itself but the timer.
  [[nodiscard]] bool is_quiet() const noexcept { return !step_ && state_ != State::holding; }
  [[nodiscard]] bool is_holding() const noexcept { return state_ == State::holding; }
  // The clocks of a whole pulse: until the next one may begin.
  [[nodiscard]] std::uint32_t whole_clocks() const noexcept { return length_ + space_; }
  [[nodiscard]] std::uint32_t length_clocks() const noexcept { return length_; }
  // The clocks before the one in which STEP falls.
  [[nodiscard]] Clock clocks_to_fall() const noexcept { return step_ ? timer_ : never; }
  // The clocks before the first one that can take a step.
  [[nodiscard]] Clock clocks_to_ready() const noexcept { return timer_ + (step_ ? space_ : 0); }
  // The same as so many calls of `clock` in which nobody asks. Not while it is holding.
  void skip(Clock clocks) noexcept {
    if (step_) {
      if (clocks <= timer_) {
        timer_ -= static_cast<std::uint32_t>(clocks);
        return;
      }
      clocks -= timer_ + 1;
      step_ = false;
      timer_ = space_ - 1;
    }
    timer_ -= static_cast<std::uint32_t>(std::min<Clock>(clocks, timer_));
  }
  // Takes a step that may be taken.
  void begin() noexcept {
    step_ = true;
    timer_ = length_ - 1;
    state_ = State::resting;
  }

  void clock(bool asked, bool down) noexcept {
    const bool taken = asked && takes(down);
    if (timer_ > 0) {
      --timer_;
    } else if (step_) {
      step_ = false;
      timer_ = space_ - 1;
    } else if (state_ == State::holding) {
      direction_ = !direction_;
      timer_ = setup_ - 1;
      state_ = State::setting;
    } else if (taken) {
      begin();
    } else if (asked) {
      timer_ = hold_ - 1;
      state_ = State::holding;
    }
  }

 private:
  enum class State { resting, holding, setting };

  [[nodiscard]] bool ready() const noexcept { return timer_ == 0 && !step_ && state_ != State::holding; }

  std::uint32_t length_ = 1, space_ = 1, setup_ = 1, hold_ = 1;
  std::uint32_t timer_ = 0;
  State state_ = State::resting;
  bool step_ = false;
  bool direction_ = true;
};

}  // namespace unitylink::device
