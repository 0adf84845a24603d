// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/ftdi_chip.hpp"

#include <algorithm>
#include <array>

namespace unitylink::ftdi {
namespace {

constexpr std::array chips{
    Chip{"FT232BM", 0x0400, 1, false, false, false}, Chip{"FT2232C", 0x0500, 2, false, true, false},
    Chip{"FT232R", 0x0600, 1, false, false, false},  Chip{"FT2232H", 0x0700, 2, true, true, true},
    Chip{"FT4232H", 0x0800, 4, true, true, false},   Chip{"FT232H", 0x0900, 1, true, true, true},
    Chip{"FT231X", 0x1000, 1, false, false, false},
};

// The chip's code for 0 to 7 eighths of a divisor. It stands in bits 14 to 16.
constexpr std::array<std::uint32_t, 8> eighths{0, 3, 2, 4, 1, 5, 6, 7};
constexpr std::uint32_t twelve_megahertz = 1u << 17;

}  // namespace

const Chip* chip_of(std::uint16_t release) noexcept {
  const auto* found = std::ranges::find(chips, release, &Chip::release);
  return found == chips.end() ? nullptr : found;
}

Divisor divisor_of(const Chip& chip, std::uint32_t baud_hz) noexcept {
  const std::uint64_t clock_hz = chip.high_speed ? 12'000'000 : 3'000'000;
  const std::uint64_t most = (1u << 17) - 1;  // 14 bits for the whole part, and three for the eighths
  std::uint64_t eighth = std::clamp<std::uint64_t>((clock_hz * 8 * 2 / std::max(baud_hz, 1u) + 1) / 2, 8, most);
  if (eighth > 8 && eighth < 16) {  // below 2 the chip has only 1 and 1.5
    eighth = eighth < 10 ? 8 : eighth < 14 ? 12 : 16;
  }
  std::uint32_t code = static_cast<std::uint32_t>(eighth >> 3) | eighths[eighth & 7] << 14;
  if (eighth == 8) {
    code = 0;
  } else if (eighth == 12) {
    code = 1;
  }
  if (chip.high_speed) {
    code |= twelve_megahertz;
  }
  const auto high = static_cast<std::uint16_t>(code >> 16);
  const auto index = static_cast<std::uint16_t>(chip.index_of_channel ? high << 8 : high);
  return {static_cast<std::uint16_t>(code & 0xFFFF), index, static_cast<std::uint32_t>(clock_hz * 8 / eighth)};
}

std::size_t strip_status(std::span<std::uint8_t> bytes, std::size_t packet_bytes) noexcept {
  std::size_t left = 0;
  for (std::size_t packet = 0; packet < bytes.size(); packet += packet_bytes) {
    const std::size_t end = std::min(packet + packet_bytes, bytes.size());
    const std::size_t begin = std::min(packet + status_bytes, end);
    std::copy(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.begin() + static_cast<std::ptrdiff_t>(end),
              bytes.begin() + static_cast<std::ptrdiff_t>(left));
    left += end - begin;
  }
  return left;
}

}  // namespace unitylink::ftdi
