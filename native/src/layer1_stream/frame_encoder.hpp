// SPDX-License-Identifier: BSD-3-Clause
// One frame of the framed protocol: kind, COBS of the payload, check, 00.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

#include "layer1_stream/frame_check.hpp"

namespace unitylink {

// Writes one frame into `room`. Example: FrameEncoder(room, request_kind::read, key).word(id, 2).word(address,
// 2).finish() gives its bytes. If the frame does not fit, or its payload is too long for any frame, finish() returns 0,
// and `room` is not valid.
class FrameEncoder {
 public:
  FrameEncoder(std::span<std::uint8_t> room, std::uint8_t kind, const FrameKey& key) noexcept : room_(room), key_(key) {
    put(kind);
    block_ = used_++;
  }

  FrameEncoder& byte(std::uint8_t value) noexcept {
    if (used_ - block_ == full) {  // after a full block there is no zero
      open_block();
    }
    payload_ += 1;
    if (value == 0) {
      open_block();
    } else {
      put(value);
    }
    return *this;
  }

  // The low `bytes` bytes of `value`, most significant first.
  FrameEncoder& word(std::uint32_t value, unsigned bytes) noexcept {
    for (unsigned left = bytes; left > 0; --left) {
      byte(static_cast<std::uint8_t>(value >> (8 * (left - 1))));
    }
    return *this;
  }

  FrameEncoder& bytes(std::span<const std::uint8_t> values) noexcept {
    for (const std::uint8_t value : values) {
      byte(value);
    }
    return *this;
  }

  [[nodiscard]] std::size_t payload_bytes() const noexcept { return payload_; }

  [[nodiscard]] std::size_t finish() noexcept {
    if (used_ > room_.size() || payload_ > frame_payload_max) {
      return 0;
    }
    close_block();
    const FrameCheck check = FrameCheck::of(room_.first(used_), key_);
    for (std::size_t index = 0; index < check.size; ++index) {
      put(check.bytes[index]);
    }
    put(protocol::frame::delimiter);
    return used_ <= room_.size() ? used_ : 0;
  }

 private:
  static constexpr std::size_t full = 255;  // bytes of a block, with its code byte

  void put(std::uint8_t byte) noexcept {
    if (used_ < room_.size()) {
      room_[used_] = byte;
    }
    ++used_;
  }
  // The code byte of a block is its size, which is known only at its end.
  void close_block() noexcept {
    if (block_ < room_.size()) {
      room_[block_] = static_cast<std::uint8_t>(used_ - block_);
    }
  }
  void open_block() noexcept {
    close_block();
    block_ = used_++;
  }

  std::span<std::uint8_t> room_;
  FrameKey key_;
  std::size_t used_ = 0;
  std::size_t block_ = 0;  // where the code byte of the block is
  std::size_t payload_ = 0;
};

}  // namespace unitylink
