// SPDX-License-Identifier: BSD-3-Clause
// Turns bytes, in chunks of any size, into checked frames, for both directions. The receiver of a frame decides what
// its kind means, and whether the payload fits the kind.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include "layer1_stream/frame_check.hpp"

namespace unitylink {

struct Frame {
  std::uint8_t kind = 0;
  std::span<const std::uint8_t> payload;
};

enum class Discard : std::uint8_t {
  check,     // the check is wrong or incomplete
  cobs,      // the check is right, but the blocks do not end before it
  too_long,  // longer than any frame may be
};

template <class T>
concept FrameSink = requires(T& sink, const Frame& frame, Discard why, std::size_t bytes, std::uint8_t kind) {
  sink.on_frame(frame);  // valid only during the call
  // between two delimiters there was no frame; `kind` is the first byte, and `bytes` their number
  sink.on_discard(why, kind, bytes);
};

class FrameDecoder {
 public:
  // From now on, frames of a session are checked with its key. Other frames need no key.
  void set_key(const FrameKey& key) noexcept { key_ = key; }
  [[nodiscard]] const FrameKey& key() const noexcept { return key_; }
  // Longer payloads are discarded as too long. The limit is at most frame_payload_max, which is the default.
  void set_payload_max(std::size_t bytes) noexcept {
    payload_max_ = std::min(bytes, frame_payload_max);
    limit_ = frame_bytes(payload_max_, true) - 1;
  }

  template <FrameSink Sink>
  void feed(std::span<const std::uint8_t> chunk, Sink& sink) {
    while (!chunk.empty()) {
      chunk = chunk.subspan(take(chunk, sink));
    }
  }

  // Takes bytes up to and including the next delimiter, or all of `chunk` if it has none. Returns how many.
  template <FrameSink Sink>
  std::size_t take(std::span<const std::uint8_t> chunk, Sink& sink) {
    // a device takes one at a time
    if (chunk.size() == 1 && chunk[0] != protocol::frame::delimiter && used_ < limit_) {
      bytes_[used_++] = chunk[0];
      return 1;
    }
    const void* end = std::memchr(chunk.data(), protocol::frame::delimiter, chunk.size());
    const std::size_t size =
        end == nullptr ? chunk.size() : static_cast<std::size_t>(static_cast<const std::uint8_t*>(end) - chunk.data());
    if (used_ + size <= limit_) {
      std::memcpy(bytes_.data() + used_, chunk.data(), size);
    } else if (used_ == 0 && size > 0) {
      bytes_[0] = chunk[0];
    }
    used_ += size;  // above the limit, bytes are only counted
    if (end == nullptr) {
      return size;
    }
    if (used_ > 0) {
      const std::size_t used = used_;
      used_ = 0;
      const std::uint8_t kind = bytes_[0];
      if (const auto why = read(used)) {
        sink.on_discard(*why, kind, used);
      } else {
        sink.on_frame(Frame{kind, payload_});
      }
    }
    return size + 1;
  }

  // Number of bytes of a frame whose end has not yet arrived. 0 directly after a delimiter.
  [[nodiscard]] std::size_t pending() const noexcept { return used_; }
  // Drops these bytes, like a device that is reset.
  void reset() noexcept { used_ = 0; }

 private:
  [[nodiscard]] std::optional<Discard> read(std::size_t used) noexcept;
  [[nodiscard]] bool decode(std::uint8_t* at, std::uint8_t* end) noexcept;

  FrameKey key_;
  std::size_t payload_max_ = frame_payload_max;
  std::size_t limit_ = frame_bytes_max;
  std::size_t used_ = 0;
  std::span<const std::uint8_t> payload_;
  std::array<std::uint8_t, frame_bytes_max> bytes_;
};

}  // namespace unitylink
