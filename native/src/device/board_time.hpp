// SPDX-License-Identifier: BSD-3-Clause
// Clocks of a device in nanoseconds, and back. In two parts: clock_hz times nanoseconds overflows within a day.
#pragma once

#include <cstdint>

#include "device/clock.hpp"

namespace unitylink::device {

inline constexpr std::uint64_t second_ns = 1'000'000'000;

[[nodiscard]] inline Clock whole_clocks(std::uint64_t ns, std::uint32_t clock_hz) noexcept {
  return ns / second_ns * clock_hz + ns % second_ns * clock_hz / second_ns;
}

[[nodiscard]] inline std::uint64_t nanoseconds(Clock clock, std::uint32_t clock_hz) noexcept {
  return clock / clock_hz * second_ns + clock % clock_hz * second_ns / clock_hz;
}

// The first nanosecond that is not before the clock.
[[nodiscard]] inline std::uint64_t nanoseconds_up(Clock clock, std::uint32_t clock_hz) noexcept {
  return clock / clock_hz * second_ns + (clock % clock_hz * second_ns + clock_hz - 1) / clock_hz;
}

}  // namespace unitylink::device
