// SPDX-License-Identifier: BSD-3-Clause
// The tokens between the frames on an RS-485 pair (docs/protocol.md, section 10), and the answer that a master
// receives.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "unitylink/protocol.hpp"

namespace unitylink::pair_bus {

inline constexpr std::uint8_t border = 0;
inline constexpr unsigned master_number = 0;

// The second byte of the token whose first byte is `first`.
[[nodiscard]] constexpr std::uint8_t token_check(std::uint8_t first) noexcept {
  unsigned rest = 0;
  for (int bit = 6; bit >= 0; --bit) {
    const bool feedback = ((rest >> 6) & 1u) != (static_cast<unsigned>(first >> bit) & 1u);
    rest = (rest << 1 & 0x7Fu) ^ (feedback ? protocol::rs485::check_polynomial : 0);
  }
  return static_cast<std::uint8_t>(protocol::rs485::check_bit | rest);
}

[[nodiscard]] constexpr std::array<std::uint8_t, 3> token(unsigned node, bool poll) noexcept {
  const auto first = static_cast<std::uint8_t>(node | (poll ? protocol::rs485::poll_bit : 0));
  return {first, token_check(first), border};
}

// All that is received between a poll and the end of the polled node's turn. Some adapters also receive what the master
// sends. This echo is left out.
class Answer {
 public:
  explicit Answer(unsigned node) noexcept : node_(node) {}

  // Returns true when the turn has ended. Bytes after its end are ignored.
  [[nodiscard]] bool take(std::span<const std::uint8_t> bytes);
  // The frames of the answer, each with its border.
  [[nodiscard]] const std::vector<std::uint8_t>& frames() const noexcept { return frames_; }
  // Whether the node has sent its own token.
  [[nodiscard]] bool spoke() const noexcept { return spoke_; }

 private:
  [[nodiscard]] bool end_message();

  unsigned node_;
  std::vector<std::uint8_t> message_;
  std::vector<std::uint8_t> frames_;
  bool selected_ = false;
  bool spoke_ = false;
};

}  // namespace unitylink::pair_bus
