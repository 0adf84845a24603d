// SPDX-License-Identifier: BSD-3-Clause
// The nonce that a HELLO answer offers, and that one OPEN takes. Without a secret the nonces count, as in the gateware.
// With a secret, the count goes through a permutation that nobody else knows. So no nonce repeats before all 65,536
// were used, and a client that does not receive the answers can only guess. Guesses are limited: after a wrong one no
// OPEN counts for a while. This time doubles each time, up to a second.
#pragma once

#include <algorithm>
#include <cstdint>

#include "device/clock.hpp"

namespace unitylink::device {

class SessionOffer {
 public:
  // `made`: earlier offers, which survive a reset. `secret` 0: no secret. `second`: in clocks.
  SessionOffer(std::uint16_t made, std::uint64_t secret, Clock second) noexcept
      : secret_(secret), rest_least_(second / 100), rest_most_(second), rest_(rest_least_), made_(made) {}

  [[nodiscard]] std::uint16_t made() const noexcept { return made_; }
  // The nonce of a new offer.
  std::uint16_t make() noexcept {
    open_ = true;
    return shown(++made_);
  }
  // True: an OPEN with this nonce is accepted. This uses the offer up.
  [[nodiscard]] bool take(std::uint16_t nonce, Clock now) noexcept {
    if (now < rests_until_) {
      return false;
    }
    if (open_ && nonce == shown(made_)) {
      open_ = false;
      rest_ = rest_least_;
      return true;
    }
    if (secret_ != 0 && !recent(nonce)) {
      rests_until_ = now + rest_;
      rest_ = std::min(rest_most_, 2 * rest_);
    }
    return false;
  }

 private:
  static constexpr std::uint16_t kept = 8;  // offers whose OPEN may be late without counting as a guess

  [[nodiscard]] bool recent(std::uint16_t nonce) const noexcept {
    for (std::uint16_t back = 0; back < kept; ++back) {
      if (nonce == shown(static_cast<std::uint16_t>(made_ - back))) {
        return true;
      }
    }
    return false;
  }
  // Four rounds of a Feistel network: a permutation for any `mixed`.
  [[nodiscard]] std::uint16_t shown(std::uint16_t count) const noexcept {
    if (secret_ == 0) {
      return count;
    }
    std::uint32_t left = count >> 8, right = count & 0xFF;
    for (std::uint64_t round = 1; round <= 4; ++round) {
      const std::uint32_t next = left ^ mixed(secret_ ^ (round << 8 | right));
      left = right;
      right = next;
    }
    return static_cast<std::uint16_t>(left << 8 | right);
  }
  // Eight bits of the finalizer of SplitMix64.
  [[nodiscard]] static std::uint32_t mixed(std::uint64_t value) noexcept {
    value = (value ^ value >> 30) * 0xBF58476D1CE4E5B9u;
    value = (value ^ value >> 27) * 0x94D049BB133111EBu;
    return static_cast<std::uint32_t>(value >> 56);
  }

  std::uint64_t secret_;
  Clock rest_least_;
  Clock rest_most_;
  Clock rest_;
  Clock rests_until_ = 0;
  std::uint16_t made_;
  bool open_ = false;
};

}  // namespace unitylink::device
