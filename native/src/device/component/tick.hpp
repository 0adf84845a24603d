// SPDX-License-Identifier: BSD-3-Clause
// The model of a phase accumulator as rate_pkg.vhd describes it: when its ticks come, without running every clock.
#pragma once

#include <cstdint>

#include "device/clock.hpp"

namespace unitylink::device {

class Tick {
 public:
  Tick(std::uint64_t clock_hz, std::uint64_t rate_hz) {
    std::uint64_t clocks = 1;
    while (clocks < (clock_hz + rate_hz - 1) / rate_hz) {
      clocks *= 2;
      ++bits_;
    }
    increment_ = ((rate_hz << bits_) + clock_hz / 2) / clock_hz;
  }

  // Ticks in the states up to `state`. The accumulator is zero in state 0.
  [[nodiscard]] std::uint64_t until(Clock state) const noexcept {
    return static_cast<std::uint64_t>(Wide{state} * increment_ >> bits_);
  }
  // The state that has tick `number`, from 1 on.
  [[nodiscard]] Clock state_of(std::uint64_t number) const noexcept {
    return static_cast<Clock>(((Wide{number} << bits_) + increment_ - 1) / increment_);
  }
  [[nodiscard]] std::uint32_t bits() const noexcept { return bits_; }  // of the accumulator, without its carry
  [[nodiscard]] std::uint64_t increment() const noexcept { return increment_; }

 private:
  __extension__ using Wide = unsigned __int128;

  std::uint32_t bits_ = 10;  // rate_precision_bits
  std::uint64_t increment_ = 1;
};

}  // namespace unitylink::device
