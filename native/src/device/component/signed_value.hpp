// SPDX-License-Identifier: BSD-3-Clause
// Signed values of fewer bits than their type, as VHDL has them.
#pragma once

#include <algorithm>
#include <cstdint>

namespace unitylink::device {

// The low bits of a value, as two's complement.
inline std::int64_t wrapped(std::int64_t value, std::uint32_t bits) noexcept {
  const std::uint32_t spare = 64 - bits;
  return static_cast<std::int64_t>(static_cast<std::uint64_t>(value) << spare) >> spare;
}

// A value in fewer bits: too large a one becomes the largest. wire_pkg.vhd has the same.
inline std::int64_t limited(std::int64_t value, std::uint32_t bits) noexcept {
  const std::int64_t end = std::int64_t{1} << (bits - 1);
  return std::clamp(value, -end, end - 1);
}

}  // namespace unitylink::device
