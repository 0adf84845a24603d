// SPDX-License-Identifier: BSD-3-Clause
// The payload of a request, taken apart. Each kind has exactly one right length for its counts.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "unitylink/protocol.hpp"

namespace unitylink::device {

// Reads big-endian fields one after the other. After a missing field, all further results are invalid.
class Fields {
 public:
  explicit Fields(std::span<const std::uint8_t> left) noexcept : left_(left) {}

  std::uint32_t take(std::size_t bytes) noexcept {
    if (bytes > left_.size()) {
      short_ = true;
      left_ = {};
      return 0;
    }
    std::uint32_t value = 0;
    for (const std::uint8_t byte : left_.first(bytes)) {
      value = value << 8 | byte;
    }
    left_ = left_.subspan(bytes);
    return value;
  }
  std::span<const std::uint8_t> rest() noexcept {
    const auto all = left_;
    left_ = {};
    return all;
  }
  [[nodiscard]] bool empty() const noexcept { return left_.empty(); }
  [[nodiscard]] bool ended_well() const noexcept { return left_.empty() && !short_; }

 private:
  std::span<const std::uint8_t> left_;
  bool short_ = false;
};

// One word of a list.
struct ListWord {
  std::uint8_t operation = 0;
  std::uint32_t address = 0;
  std::uint32_t value = 0;
  std::uint32_t mask = 0;

  [[nodiscard]] bool writes() const noexcept { return operation >= protocol::list_operation::write; }
};

// A word of an exchange group: the low `bytes` bytes of it.
struct ExchangeWord {
  std::uint32_t address = 0;
  std::uint32_t bytes = 0;
};

struct FrameRequest {
  std::uint8_t operation = 0;  // the kind without the chained and barrier bits
  std::uint16_t id = 0;        // the id, or the number of a post
  bool chained = false;
  std::optional<std::uint16_t> barrier;
  std::uint32_t address = 0;  // the address of a word or a control register, or the number of a group
  std::uint32_t value = 0;    // value to write, count of read_control, or divisor of define_group
  std::uint8_t flags = 0;
  std::vector<ListWord> words;
  std::vector<std::uint32_t> addresses;  // of define_group
  std::vector<ExchangeWord> members;     // words of define_exchange: first outputs, then inputs
  std::size_t outputs = 0;
  std::span<const std::uint8_t> data;  // the outputs of an exchange

  struct Widths {
    std::size_t address_bytes;
    std::size_t data_bytes;
  };

  // False if the form is wrong. The vectors keep their memory from frame to frame.
  [[nodiscard]] bool parse(std::uint8_t kind, std::span<const std::uint8_t> payload, Widths widths);
  [[nodiscard]] bool parse_post(std::uint8_t kind, std::span<const std::uint8_t> payload, Widths widths);

 private:
  [[nodiscard]] bool parse_list(Fields& fields, Widths widths);
};

}  // namespace unitylink::device
