// SPDX-License-Identifier: BSD-3-Clause
// What a device reports about itself in its answer to HELLO.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "layer2_message/framed_request.hpp"

namespace unitylink {

struct Greeting {
  std::uint32_t version = 0;  // version of the protocol; 0: there is none that both sides speak
  std::uint32_t nonce = 0;
  std::uint32_t epoch = 0;  // epoch of the session that is open at the device
  std::uint32_t address_bytes = 0;
  std::uint32_t data_bytes = 0;
  std::uint32_t credit = 0;       // bytes of requests that may be unanswered
  std::uint32_t request_max = 0;  // bytes of the longest request payload
  std::uint32_t reply_max = 0;    // bytes of the longest reply payload
  std::uint32_t window = 0;       // requests that may be unanswered
  std::uint32_t cache = 0;        // bytes of a reply that are kept for a repeat
  std::uint32_t features = 0;
  std::uint64_t spec_hash = 0;

  // Whether a session with `other` could continue with this device.
  [[nodiscard]] bool same_device(const Greeting& other) const noexcept {
    return address_bytes == other.address_bytes && data_bytes == other.data_bytes && spec_hash == other.spec_hash;
  }

  // Empty if the length is wrong, or if no device can have these values.
  [[nodiscard]] static std::optional<Greeting> parse(std::span<const std::uint8_t> payload) noexcept {
    if (payload.size() != 25) {
      return std::nullopt;
    }
    const std::uint8_t* at = payload.data();
    const auto take = [&at](std::size_t bytes) {
      const std::uint32_t value = number_at(at, bytes);
      at += bytes;
      return value;
    };
    Greeting told;
    told.version = take(1);
    told.nonce = take(2);
    told.epoch = take(2);
    told.address_bytes = take(1);
    told.data_bytes = take(1);
    told.credit = take(2);
    told.request_max = take(2);
    told.reply_max = take(2);
    told.window = take(1);
    told.cache = take(1);
    told.features = take(2);
    told.spec_hash = std::uint64_t{take(4)} << 32;
    told.spec_hash |= take(4);
    const auto width = [](std::uint32_t bytes) { return bytes >= 1 && bytes <= 4; };
    const bool whole = width(told.address_bytes) && width(told.data_bytes) && told.window > 0 &&
                       (told.window & (told.window - 1)) == 0 &&
                       told.request_max >= 4 + told.address_bytes + told.data_bytes && told.reply_max >= 8;
    return whole ? std::optional(told) : std::nullopt;
  }
};

}  // namespace unitylink
