// SPDX-License-Identifier: BSD-3-Clause
// The model of ticker.vhd: exact ticks where the clock is a multiple of the rate, else those of rate_pkg.vhd.
#pragma once

#include <cstdint>

#include "device/component/component_configuration.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

class Ticker {
 public:
  Ticker(std::uint64_t clock_hz, std::uint64_t rate_hz)
      : clocks_(clock_hz % rate_hz == 0 ? clock_hz / rate_hz : 0), tick_(clock_hz, rate_hz) {}
  // One for each microsecond of a component's clock.
  explicit Ticker(const ComponentConfiguration& from)
      : Ticker(static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000)), 1'000'000) {}

  // Ticks in the states up to `state`.
  [[nodiscard]] std::uint64_t until(Clock state) const noexcept {
    return clocks_ != 0 ? state / clocks_ : tick_.until(state);
  }
  // The state that has tick `number`, from 1 on.
  [[nodiscard]] Clock state_of(std::uint64_t number) const noexcept {
    return clocks_ != 0 ? number * clocks_ : tick_.state_of(number);
  }
  // Does this edge see a tick?
  [[nodiscard]] bool is_tick(Clock edge) const noexcept { return edge != 0 && until(edge) != until(edge - 1); }
  // The first edge behind this one that sees a tick.
  [[nodiscard]] Clock behind(Clock edge) const noexcept { return state_of(until(edge) + 1); }

 private:
  Clock clocks_;  // of a tick, if it is exact
  Tick tick_;
};

}  // namespace unitylink::device
