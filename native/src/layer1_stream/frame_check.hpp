// SPDX-License-Identifier: BSD-3-Clause
// The check at the end of a frame: which CRC, its start value, and its bytes without zeros (docs/protocol.md, section
// 1).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "layer1_stream/frame_crc.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {

// What both sides of a session know, but no frame contains.
struct FrameKey {
  std::uint16_t epoch = protocol::frame::open_epoch;
  bool always_long = false;  // CRC-32C in every frame

  friend bool operator==(const FrameKey&, const FrameKey&) = default;
};

// The longest payload of any frame here. With one byte more, the CRC would not find every error of three bits.
inline constexpr std::size_t frame_payload_max = 4072;
// Kind, COBS and check of this payload, without the delimiter.
inline constexpr std::size_t frame_bytes_max =
    1 + frame_payload_max + (frame_payload_max + 253) / 254 + protocol::frame::crc32_bytes;
static_assert(frame_bytes_max == 4095);

// The most bytes of a frame with this payload, with the delimiter. The length is exact below 254 bytes of payload.
[[nodiscard]] constexpr std::size_t frame_bytes(std::size_t payload, bool always_long = false) noexcept {
  const std::size_t body = 1 + payload + (payload < 254 ? 1 : (payload + 253) / 254);
  return body +
         (always_long || body > protocol::frame::short_max ? protocol::frame::crc32_bytes
                                                           : protocol::frame::crc16_bytes) +
         1;
}

// Requests that open a session, and their answers, cannot know its epoch. All other frames start with it.
[[nodiscard]] constexpr bool outside_session(std::uint8_t kind) noexcept {
  return kind == protocol::request_kind::hello || kind == protocol::request_kind::open ||
         kind == protocol::device_kind::hello || kind == protocol::device_kind::open ||
         kind == protocol::device_kind::closed;
}

// The bytes of a check: 3 or 5.
struct FrameCheck {
  std::array<std::uint8_t, protocol::frame::crc32_bytes> bytes{};
  std::size_t size = 0;

  // The check of `body`, which is the kind and the COBS bytes as on the wire.
  [[nodiscard]] static constexpr FrameCheck of(std::span<const std::uint8_t> body, const FrameKey& session) noexcept {
    const FrameKey key = outside_session(body[0]) ? FrameKey{} : session;
    const bool is_long = key.always_long || body.size() > protocol::frame::short_max;
    FrameCheck check;
    check.size = is_long ? protocol::frame::crc32_bytes : protocol::frame::crc16_bytes;
    std::uint32_t sum =
        is_long ? Crc32c::of(body, std::uint32_t{key.epoch} << 16 | key.epoch) : Crc16::of(body, key.epoch);
    for (std::size_t index = 0; index < check.size; ++index, sum >>= 7) {
      check.bytes[index] = static_cast<std::uint8_t>(0x80 | (sum & 0x7F));
    }
    return check;
  }
};

}  // namespace unitylink
