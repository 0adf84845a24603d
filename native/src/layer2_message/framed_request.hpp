// SPDX-License-Identifier: BSD-3-Clause
// The payload of each framed request and of its reply (docs/protocol.md, section 3).
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "layer1_stream/configuration.hpp"
#include "layer1_stream/frame_encoder.hpp"
#include "layer2_message/exchange.hpp"
#include "unitylink/protocol.hpp"

namespace unitylink {

// The number in the first `bytes` bytes, most significant first. `data` must have them.
[[nodiscard]] constexpr std::uint32_t number_at(const std::uint8_t* data, std::size_t bytes) noexcept {
  std::uint32_t value = 0;
  for (std::size_t index = 0; index < bytes; ++index) {
    value = value << 8 | data[index];
  }
  return value;
}

// The length of all operations of a list, without its flags.
[[nodiscard]] std::size_t bytes_of(std::span<const ListWord> steps, const Configuration& configuration) noexcept;
// Encodes words to write as the operations of a POST_LIST.
void put_post(FrameEncoder& encoder, std::span<const std::uint32_t> addresses, std::span<const std::uint32_t> words,
              const Configuration& configuration) noexcept;
// The length of the words of an exchange group.
[[nodiscard]] std::size_t bytes_of(std::span<const ExchangeWord> words) noexcept;
// The kind of an exchange's frame, without the chained and barrier bits.
[[nodiscard]] std::uint8_t framed_kind(const Exchange& exchange) noexcept;
// Encodes what follows id and barrier.
void put_request(FrameEncoder& encoder, const Exchange& exchange, const Configuration& configuration) noexcept;
// The length of a successful reply, after `posts`.
[[nodiscard]] std::size_t reply_bytes(const Exchange& exchange, const Configuration& configuration) noexcept;
inline constexpr std::size_t sync_reply_bytes = 7;
// Decodes the part of a reply after `posts`. False: its length is not exactly right for this status.
[[nodiscard]] bool take_reply(Exchange& exchange, std::uint8_t status, std::span<const std::uint8_t> body,
                              const Configuration& configuration) noexcept;
// True: the device has executed the request, or tried to, so its id is used.
[[nodiscard]] constexpr bool executed(std::uint8_t status) noexcept {
  return status == protocol::reply_status::ok || status == protocol::reply_status::bus_error ||
         status == protocol::reply_status::bus_timeout;
}
// "bus_error", "denied" …; "" for ok; empty for a status that the protocol does not have.
[[nodiscard]] std::optional<std::string_view> framed_status_name(std::uint8_t status) noexcept;

}  // namespace unitylink
