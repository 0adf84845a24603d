// SPDX-License-Identifier: BSD-3-Clause
// What became of an exchange, in words a person can act on.
#pragma once

#include <cstdint>
#include <new>
#include <span>
#include <string>
#include <string_view>

#include "layer0_driver/status.hpp"
#include "layer2_message/exchange.hpp"

namespace unitylink {

struct FailureContext {
  std::uint32_t address_bytes = 0;
  std::uint64_t last_answer_ns = 0;  // 0: the device has never answered
  std::string_view reason;           // why the link has ended, empty when it has not
};

// A sentence; nothing where there is no memory for it: what happened is told all the same, and ends nothing.
template <class Make>
[[nodiscard]] std::string in_words(const Make& make) noexcept {
  try {
    return make();
  } catch (const std::bad_alloc&) {
    return {};
  }
}

[[nodiscard]] std::string hex_address(std::uint32_t address, std::uint32_t address_bytes);
[[nodiscard]] std::string duration_text(std::uint64_t ns);
// Of a call that goes on after its writes: they were executed, so that `down`, which says that nothing was sent, would not be true.
[[nodiscard]] Outcome behind_writes(Outcome outcome);
// The one to tell of: not one that was given up because of it. exchanges.size() when none has failed.
[[nodiscard]] std::size_t first_failed(std::span<const Exchange> exchanges) noexcept;
[[nodiscard]] Outcome describe(const Exchange& exchange, const FailureContext& context);

}  // namespace unitylink
