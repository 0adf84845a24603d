// SPDX-License-Identifier: BSD-3-Clause
// The result of an exchange as a text with a remedy.
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
  std::string_view reason;           // why the link has ended; empty if it has not
};

// A sentence. Without memory for it, it is empty, and the failure is still reported.
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
// Corrects the status of a call that continues after its writes. `down` says that nothing was sent. But the writes were
// executed.
[[nodiscard]] Outcome behind_writes(Outcome outcome);
// The number of the exchange whose failure is reported. Exchanges that were given up because of it do not count.
// exchanges.size(): none has failed.
[[nodiscard]] std::size_t first_failed(std::span<const Exchange> exchanges) noexcept;
[[nodiscard]] Outcome describe(const Exchange& exchange, const FailureContext& context);

}  // namespace unitylink
