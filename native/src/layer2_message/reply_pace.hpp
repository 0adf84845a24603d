// SPDX-License-Identifier: BSD-3-Clause
// Measures how soon a device replies. To put a thread to sleep and wake it takes an operating system 5 to 30 us. If
// replies usually come within `most_ns`, a caller checks the port for that long before it sleeps. With a slower device
// (over USB: at least 125 us) it sleeps at once, and costs no processor time.
#pragma once

#include <algorithm>
#include <cstdint>

namespace unitylink {

class ReplyPace {
 public:
  explicit ReplyPace(std::uint64_t most_ns) noexcept : most_ns_(most_ns), usual_ns_(slowest * most_ns) {}

  // How long to check the port before sleeping; 0: sleep at once.
  [[nodiscard]] std::uint64_t look_ns() const noexcept { return usual_ns_ < most_ns_ ? most_ns_ : 0; }
  // Reports how long a caller has waited until bytes came. One slow reply in a hundred changes nothing. A slow device
  // is recognised after a few replies.
  void waited(std::uint64_t ns) noexcept {
    usual_ns_ = (usual_ns_ * (weight - 1) + std::min(ns, slowest * most_ns_)) / weight;
  }

 private:
  static constexpr std::uint64_t weight = 8;
  static constexpr std::uint64_t slowest = 4;  // a longer wait counts as slowest * most_ns

  std::uint64_t most_ns_;
  std::uint64_t usual_ns_;  // a running mean
};

}  // namespace unitylink
