// SPDX-License-Identifier: BSD-3-Clause
// What a client of `unitylink serve` knows about the server's clock, which counts us in 32 bits. Sans I/O.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <optional>

namespace unitylink {

// What it knows comes from answers: asked at a time of the client, told a time of the server.
class ServerClock {
 public:
  void forget() noexcept { known_ = false; }

  // Takes an answer, if it says more than what is known.
  void learn(std::uint32_t told_us, std::uint64_t asked_ns) noexcept {
    const std::optional<std::uint32_t> latest = latest_us(asked_ns);
    if (!latest || static_cast<std::int32_t>(told_us - *latest) < 0) {
      known_ = true;
      told_us_ = told_us;
      asked_ns_ = asked_ns;
    }
  }

  // A time that the server's clock had not passed at `at_ns`: it was asked before it answered. It is later by up to the
  // round trip of the question, and by what the clocks may have drifted since.
  [[nodiscard]] std::optional<std::uint32_t> latest_us(std::uint64_t at_ns) const noexcept {
    if (!known_) {
      return std::nullopt;
    }
    const auto since_ns = static_cast<std::int64_t>(at_ns - asked_ns_);
    const std::int64_t latest_ns = since_ns + std::abs(since_ns) / drift_part;
    return told_us_ + static_cast<std::uint32_t>(latest_ns / 1000 + 1);
  }

 private:
  static constexpr std::int64_t drift_part = 5000;  // two crystals differ by at most 200 ppm

  bool known_ = false;
  std::uint32_t told_us_ = 0;
  std::uint64_t asked_ns_ = 0;
};

}  // namespace unitylink
