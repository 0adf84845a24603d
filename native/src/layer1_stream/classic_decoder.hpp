// SPDX-License-Identifier: BSD-3-Clause
// Turns bytes from the device, in chunks of any size, into messages. No I/O, no clock, no allocation.
//
// The decoder accepts only whole lines. A line gives no value if it is too long, has an odd digit, a wrong letter, a
// wrong or missing checksum, or a head within it. A lost line feed costs the message before it, not the one after it.
// The decoder may start within a line: everything up to the first head is garbage, and is counted. Hex digits may be
// upper or lower case. Gateware sends lower case, and the case carries no information.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string_view>

#include "layer1_stream/crc8.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {

inline constexpr std::string_view busy_line = "?busy";  // of any board that serves another program

enum class MessageKind : std::uint8_t {
  reply,              // letters and data; for CNF `fields` and `checksum` instead of data
  application_error,  // error; letters and data are what came before it
  datalink_error,     // code
  busy,               // busy_line: the board serves another program
  bad_checksum,       // head says whether it was a reply or a publish
  malformed,          // head: as in bad_checksum
};

struct Message {
  MessageKind kind = MessageKind::malformed;
  char head = 0;
  std::uint8_t code = 0;
  std::optional<std::uint8_t> checksum;
  std::string_view letters;
  std::string_view error;
  std::string_view fields;
  std::span<const std::uint8_t> data;

  [[nodiscard]] bool is_publish() const noexcept {
    return head == protocol::bytes::plain_publish || head == protocol::bytes::checked_publish;
  }
};

struct Publish {
  std::uint32_t group = 0;
  std::uint32_t count = 0;  // the number in the message; `words` are those that were received
  bool checked = false;
  std::span<const std::uint32_t> words;
};

template <class T>
concept DecoderSink = requires(T& sink, const Message& message, const Publish& publish, std::size_t bytes) {
  sink.on_message(message);  // its views are valid only during the call
  sink.on_publish(publish);
  sink.on_garbage(bytes);  // bytes outside all messages
};

class ClassicDecoder {
 public:
  // The longest line that gateware can send: RSI of 255 addresses of 4 bytes, with room for an error after it.
  static constexpr std::size_t line_bytes_max = 2304;

  explicit ClassicDecoder(const Crc8& sum = Crc8{}) noexcept;

  // Until the data width is known, publishes are not decoded: they are reported without words.
  void set_data_bytes(std::uint32_t bytes) noexcept { data_bytes_ = bytes; }
  [[nodiscard]] const Crc8& sum() const noexcept { return sum_; }

  template <DecoderSink Sink>
  void feed(std::span<const std::uint8_t> chunk, Sink& sink) {
    while (!chunk.empty()) {
      if (used_ == 0) {
        if (const std::size_t taken = take_publish(chunk); taken > 0) {
          sink.on_publish(publish_);
          chunk = chunk.subspan(taken);
          continue;
        }
      }
      const void* end = std::memchr(chunk.data(), protocol::bytes::line_feed, chunk.size());
      const std::size_t size = end == nullptr
                                   ? chunk.size()
                                   : static_cast<std::size_t>(static_cast<const std::uint8_t*>(end) - chunk.data()) + 1;
      const std::span<const std::uint8_t> piece = chunk.first(size);
      chunk = chunk.subspan(size);
      if (end != nullptr && used_ == 0 && size <= line_bytes_max) {
        read_line(piece, sink);  // the line is complete in the chunk: no copy
        continue;
      }
      if (used_ + size <= line_bytes_max) {
        std::memcpy(line_.data() + used_, piece.data(), size);
      }
      used_ += size;  // if the buffer is full, the bytes are only counted
      if (end != nullptr) {
        if (used_ <= line_bytes_max) {
          read_line(std::span<const std::uint8_t>(line_.data(), used_), sink);
        } else {
          sink.on_garbage(used_);
        }
        used_ = 0;
      }
    }
  }

  // Number of bytes of a line whose end has not yet arrived.
  [[nodiscard]] std::size_t pending() const noexcept { return used_; }

 private:
  enum class Found : std::uint8_t { message, publish, garbage };

  template <DecoderSink Sink>
  void read_line(std::span<const std::uint8_t> line, Sink& sink) {
    const std::span<const std::uint8_t> body = line.first(line.size() - 1);
    std::size_t begin = 0;
    for (std::size_t index = 1; index < body.size(); ++index) {
      if (is_head(body[index])) {  // the end of the line before it was lost
        deliver(cut(body.subspan(begin, index - begin)), index - begin, sink);
        begin = index;
      }
    }
    deliver(read_message(body.subspan(begin)), line.size() - begin, sink);
  }

  template <DecoderSink Sink>
  void deliver(Found found, std::size_t bytes, Sink& sink) {
    switch (found) {
      case Found::message: sink.on_message(message_); break;
      case Found::publish: sink.on_publish(publish_); break;
      case Found::garbage: sink.on_garbage(bytes); break;
    }
  }

  static constexpr bool is_head(std::uint8_t byte) noexcept { return byte >= '#' && byte <= '&'; }

  std::size_t take_publish(std::span<const std::uint8_t> chunk) noexcept;
  template <unsigned DataBytes>
  std::size_t take_publish_of(std::span<const std::uint8_t> chunk) noexcept;
  Found cut(std::span<const std::uint8_t> body) noexcept;
  Found read_message(std::span<const std::uint8_t> body) noexcept;
  Found read_headed(std::span<const std::uint8_t> body) noexcept;
  Found read_publish() noexcept;

  Crc8 sum_;
  std::uint8_t publish_seed_;
  std::uint32_t data_bytes_ = 0;
  std::size_t used_ = 0;
  Message message_;
  Publish publish_;
  std::array<std::uint8_t, line_bytes_max> line_;
  std::array<std::uint8_t, line_bytes_max / 2> data_;
  std::array<std::uint32_t, line_bytes_max / 2> words_;
};

}  // namespace unitylink
