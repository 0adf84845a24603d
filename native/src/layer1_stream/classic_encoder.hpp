// SPDX-License-Identifier: BSD-3-Clause
// Requests of the classic protocol as text: '#' or '$', letters, hex digits, a checksum if wanted, line feed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>

#include "layer1_stream/crc8.hpp"
#include "layer1_stream/hex.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {

// The length of a message of this shape, so that a caller can make room before it encodes.
[[nodiscard]] constexpr std::size_t encoded_bytes(std::size_t letters, std::size_t data_bytes, bool checked) noexcept {
  return 1 + letters + (data_bytes > 0 ? 1 + 2 * data_bytes : 0) + (checked ? 3 : 0) + 1;
}

// Writes one message into `room`. Example: ClassicEncoder(room, sum, true).command("R").word(0x12, 1).finish() gives
// "$R:12*58\n". For a message that does not fit, finish() returns 0, and `room` is not valid.
class ClassicEncoder {
 public:
  ClassicEncoder(std::span<std::uint8_t> room, const Crc8& sum, bool checked) noexcept
      : room_(room), sum_(sum), checked_(checked) {
    put(checked ? protocol::bytes::checked_head : protocol::bytes::plain_head);
  }

  ClassicEncoder& command(std::string_view letters) noexcept {
    for (const char letter : letters) {
      put(letter);
      remainder_ = sum_.update(remainder_, static_cast<std::uint8_t>(letter));
    }
    return *this;
  }

  ClassicEncoder& byte(std::uint8_t value) noexcept {
    if (!data_begun_) {
      put(protocol::bytes::data_mark);
      data_begun_ = true;
    }
    put(upper_digits[value >> 4]);
    put(upper_digits[value & 15]);
    remainder_ = sum_.update(remainder_, value);
    return *this;
  }

  // The low `bytes` bytes of `value`, most significant first.
  ClassicEncoder& word(std::uint32_t value, unsigned bytes) noexcept {
    for (unsigned left = bytes; left > 0; --left) {
      byte(static_cast<std::uint8_t>(value >> (8 * (left - 1))));
    }
    return *this;
  }

  [[nodiscard]] std::size_t finish() noexcept {
    if (checked_) {
      const std::uint8_t sum = remainder_;
      put(protocol::bytes::checksum_mark);
      put(upper_digits[sum >> 4]);
      put(upper_digits[sum & 15]);
    }
    put(protocol::bytes::line_feed);
    return used_ <= room_.size() ? used_ : 0;
  }

 private:
  void put(char character) noexcept {
    if (used_ < room_.size()) {
      room_[used_] = static_cast<std::uint8_t>(character);
    }
    ++used_;
  }

  std::span<std::uint8_t> room_;
  const Crc8& sum_;
  std::size_t used_ = 0;
  std::uint8_t remainder_ = protocol::crc8::initial;
  bool checked_;
  bool data_begun_ = false;
};

}  // namespace unitylink
