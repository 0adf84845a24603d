// SPDX-License-Identifier: BSD-3-Clause
// What FTDI's chips want on USB, from their data sheets and application notes (AN_232B-04 latency and event character,
// AN_130 synchronous FIFO, AN_120 baud rates): vendor requests, baud rate divisors, and the two status bytes at the
// head of each packet.
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
  reset = 0x00,  // value 0 the chip, 1 what it holds for the PC, 2 what it holds for the board
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
inline constexpr std::uint16_t mode_sync_fifo = 0x40FF;  // all lines belong to the FIFO
inline constexpr std::uint16_t flow_rts_cts = 0x0100;    // in the index

struct Chip {
  std::string_view name;
  std::uint16_t release;  // bcdDevice
  std::uint8_t channels;
  bool high_speed;        // 480 Mbit/s, 12 MHz divided for the baud rate; else 3 MHz
  bool index_of_channel;  // requests carry the channel, also beside the baud rate
  bool sync_fifo;         // on channel A
};

// The chip of a device by its release number; nullptr for one that is not known.
[[nodiscard]] const Chip* chip_of(std::uint16_t release) noexcept;

struct Divisor {
  std::uint16_t value = 0;
  std::uint16_t index = 0;    // without the channel
  std::uint32_t baud_hz = 0;  // what it really gives
};

// The divisor nearest to `baud_hz`; the caller judges how near it is.
[[nodiscard]] Divisor divisor_of(const Chip& chip, std::uint32_t baud_hz) noexcept;

// Moves what is no status to the front of `bytes`: each packet of `packet_bytes` begins with two bytes of it. Returns
// how many are left.
[[nodiscard]] std::size_t strip_status(std::span<std::uint8_t> bytes, std::size_t packet_bytes) noexcept;

}  // namespace unitylink::ftdi
