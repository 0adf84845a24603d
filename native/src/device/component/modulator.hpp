// SPDX-License-Identifier: BSD-3-Clause
// A sigma-delta modulator of second order, outside of the pins: a bit at each rise of its clock. Its sums are whole
// numbers, so its bits are the same wherever it runs.
#pragma once

#include <algorithm>
#include <cstdint>

#include "device/clock.hpp"

namespace unitylink::device {

// Its lines: places among the outputs and the inputs of a component.
struct ModulatorLines {
  std::uint32_t mclk = 0;
  std::uint32_t data = 0;
};

class Modulator {
 public:
  static constexpr std::int64_t full = std::int64_t{1} << 30;  // the input at which all bits would be 1

  // The input goes evenly from where it is to `level`, from `now` until `until`, and stays there.
  void lead(std::int64_t level, Clock now, Clock until) noexcept {
    from_ = at(now);
    to_ = std::clamp(level, -full, full);
    begun_ = now;
    until_ = until;
    slope_ = until > now ? (to_ - from_) * fraction / static_cast<std::int64_t>(until - now) : 0;
  }

  // The bit of a rise in this state. Calls come in the order of time.
  [[nodiscard]] bool bit(Clock state) noexcept {
    bool high = second_ >= 0;
    if (equals_ == equal_most && high == last_) {
      high = !high;
    }
    equals_ = high == last_ ? equals_ + 1 : 1;
    last_ = high;
    const std::int64_t back = high ? full : -full;
    first_ = std::clamp(first_ + at(state) - back, -16 * full, 16 * full);
    second_ = std::clamp(second_ + first_ - 2 * back, -64 * full, 64 * full);
    return high;
  }

  bool plugged = true;  // else another one drives the line

 private:
  static constexpr std::int64_t fraction = 1 << 16;
  static constexpr std::uint32_t equal_most = 127;  // an AMC1306 gives an opposite bit then

  [[nodiscard]] std::int64_t at(Clock state) const noexcept {
    if (state >= until_) {
      return to_;
    }
    return state <= begun_ ? from_ : from_ + slope_ * static_cast<std::int64_t>(state - begun_) / fraction;
  }

  std::int64_t from_ = 0;
  std::int64_t to_ = 0;
  std::int64_t slope_ = 0;  // a clock, in 1/fraction
  Clock begun_ = 0;
  Clock until_ = 0;
  std::int64_t first_ = 0;   // twice the first sum
  std::int64_t second_ = 0;  // four times the second one
  std::uint32_t equals_ = 0;
  bool last_ = false;
};

}  // namespace unitylink::device
