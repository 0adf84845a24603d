// SPDX-License-Identifier: BSD-3-Clause
#include "layer1_stream/frame_decoder.hpp"

namespace unitylink {
namespace {

constexpr std::size_t body_bytes_min = 2;  // the kind, and COBS of an empty payload
constexpr std::uint8_t full_block = 0xFF;

}  // namespace

std::optional<Discard> FrameDecoder::read(std::size_t used) noexcept {
  using protocol::frame::crc16_bytes, protocol::frame::crc32_bytes, protocol::frame::short_max;
  if (used > limit_) {
    return Discard::too_long;
  }
  const bool is_long = used > short_max + crc16_bytes || (key_.always_long && !outside_session(bytes_[0]));
  const std::size_t check_bytes = is_long ? crc32_bytes : crc16_bytes;
  if (used < body_bytes_min + check_bytes) {
    return Discard::check;
  }
  // If a body is too short for a long check, it is tried with a short one here. So it never passes.
  const std::span<const std::uint8_t> body(bytes_.data(), used - check_bytes);
  const FrameCheck check = FrameCheck::of(body, key_);
  if (check.size != check_bytes || std::memcmp(check.bytes.data(), body.data() + body.size(), check_bytes) != 0) {
    return Discard::check;
  }
  if (!decode(bytes_.data() + 1, bytes_.data() + body.size())) {
    return Discard::cobs;
  }
  if (payload_.size() > payload_max_) {
    return Discard::too_long;
  }
  return std::nullopt;
}

// In place: the code byte of a block becomes the zero before the next block. Bytes move only after a full block.
bool FrameDecoder::decode(std::uint8_t* at, std::uint8_t* end) noexcept {
  std::uint8_t* const begin = at + 1;
  std::uint8_t* write = begin;
  std::uint8_t code = *at;
  while (true) {
    const std::size_t run = code - std::size_t{1};
    if (static_cast<std::size_t>(end - at) < code) {
      return false;
    }
    if (write != at + 1) {
      std::memmove(write, at + 1, run);
    }
    write += run;
    at += code;
    if (at == end) {
      payload_ = std::span<const std::uint8_t>(begin, static_cast<std::size_t>(write - begin));
      return true;
    }
    const bool full = code == full_block;
    code = *at;  // before a zero is put in its place
    if (!full) {
      *write++ = 0;
    }
  }
}

}  // namespace unitylink
