// SPDX-License-Identifier: BSD-3-Clause
// The phase of a PWM period: an accumulator of rate_pkg.vhd that stands at zero while it does not run.
#pragma once

#include <cstdint>

#include "device/clock.hpp"
#include "device/component/component_configuration.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

class Period {
 public:
  struct Phase {
    std::uint64_t low = 0;  // 0 to turn() - 1
    bool tick = false;      // the period has just begun
  };

  explicit Period(const ComponentConfiguration& from)
      : rate_(static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000)),
              static_cast<std::uint64_t>(from.generic("frequency_hz", 20'000))) {}

  [[nodiscard]] std::uint32_t bits() const noexcept { return rate_.bits(); }
  [[nodiscard]] std::uint64_t turn() const noexcept { return std::uint64_t{1} << rate_.bits(); }

  // The phase in a state. It has run, or not, since the last call of `step`.
  [[nodiscard]] Phase at(Clock state, bool running) const noexcept {
    return state == state_ || !running ? phase_ : after(phase_.low, state - state_);
  }

  // The edge of state `now`. Returns the phase behind it.
  Phase step(Clock edge, Phase now, bool running) noexcept {
    phase_ = running ? after(now.low, 1) : Phase{};
    state_ = edge + 1;
    return phase_;
  }

  // Clocks from this phase until `later`, which is above it.
  [[nodiscard]] Clock until(Phase from, std::uint64_t later) const noexcept {
    return (later - from.low + rate_.increment() - 1) / rate_.increment();
  }

 private:
  [[nodiscard]] Phase after(std::uint64_t low, Clock clocks) const noexcept {
    const std::uint64_t sum = (low + clocks * rate_.increment()) & (turn() - 1);
    return {sum, sum < rate_.increment()};
  }

  Tick rate_;
  Phase phase_;
  Clock state_ = 0;  // that has phase_
};

}  // namespace unitylink::device
