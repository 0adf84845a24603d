// SPDX-License-Identifier: BSD-3-Clause
// How FTDI's chips are used over USB: vendor requests, baud rate divisors, and the two status bytes at the beginning of
// each packet. Sources: data sheets, and the application notes AN_232B-04 (latency, event character), AN_130
// (synchronous FIFO) and AN_120 (baud rates).
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

namespace unitylink::ftdi {

inline constexpr std::uint16_t vendor = 0x0403;
inline constexpr std::uint8_t request_type = 0x40;  // vendor, to the device
inline constexpr std::size_t status_bytes = 2;

enum class Request : std::uint8_t {
  reset = 0x00,  // value 0: the chip; 1: drops its bytes for the PC; 2: drops its bytes for the board
  flow_control = 0x02,
  baud_rate = 0x03,
  data_format = 0x04,
  event_character = 0x06,
  latency_timer = 0x09,
  bit_mode = 0x0B,
};

inline constexpr std::uint16_t format_8n1 = 8;
inline constexpr std::uint16_t event_enabled = 0x100;
inline constexpr std::uint16_t mode_reset = 0x0000;
inline constexpr std::uint16_t mode_sync_fifo = 0x40FF;  // all pins are used by the FIFO
inline constexpr std::uint16_t flow_rts_cts = 0x0100;    // goes into the index

struct Chip {
  std::string_view name;
  std::uint16_t release;  // bcdDevice
  std::uint8_t channels;
  bool high_speed;        // 480 Mbit/s, and the baud rate is 12 MHz / divisor; else 3 MHz / divisor
  bool index_of_channel;  // the low byte of the index is the channel, also in the request for the baud rate
  bool sync_fifo;         // on channel A
};

// The chip with this release number; nullptr: not known.
[[nodiscard]] const Chip* chip_of(std::uint16_t release) noexcept;

struct Divisor {
  std::uint16_t value = 0;
  std::uint16_t index = 0;    // without the channel
  std::uint32_t baud_hz = 0;  // the resulting baud rate
};

// The divisor whose baud rate is nearest to `baud_hz`. The caller decides whether that is near enough.
[[nodiscard]] Divisor divisor_of(const Chip& chip, std::uint32_t baud_hz) noexcept;

// Removes the two status bytes at the beginning of each packet of `packet_bytes`, and moves the rest together. Returns
// the number of bytes that remain.
[[nodiscard]] std::size_t strip_status(std::span<std::uint8_t> bytes, std::size_t packet_bytes) noexcept;

}  // namespace unitylink::ftdi
