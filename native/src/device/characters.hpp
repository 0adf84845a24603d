// SPDX-License-Identifier: BSD-3-Clause
// What a received character can mean.
#pragma once

#include "unitylink/protocol.hpp"

namespace unitylink::device {

constexpr bool is_letter(char c) noexcept { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z'); }
constexpr bool is_separator(char c) noexcept { return c == '\t' || c == ' ' || c == ',' || c == '.'; }
constexpr bool is_head(char c) noexcept {
  return c == protocol::bytes::plain_head || c == protocol::bytes::checked_head ||
         c == protocol::bytes::plain_publish || c == protocol::bytes::checked_publish;
}
constexpr bool is_end(char c) noexcept {
  return c == protocol::bytes::line_feed || c == protocol::bytes::carriage_return;
}

}  // namespace unitylink::device
