// SPDX-License-Identifier: BSD-3-Clause
// How soon a device replies. Falling asleep and being woken takes the operating system 5 to 30 us. Where replies
// usually come within `most_ns`, a caller looks at the port for that long before it sleeps. A device that is slower
// (over USB: 125 us at least) costs no processor time that way.
#pragma once

#include <algorithm>
#include <cstdint>

namespace unitylink {

class ReplyPace {
 public:
  explicit ReplyPace(std::uint64_t most_ns) noexcept : most_ns_(most_ns), usual_ns_(slowest * most_ns) {}

  // How long to look before sleeping; 0: sleep at once.
  [[nodiscard]] std::uint64_t look_ns() const noexcept { return usual_ns_ < most_ns_ ? most_ns_ : 0; }
  // A caller has waited this long, for whatever came. One slow reply in a hundred changes nothing, a slow device is
  // known after a few.
  void waited(std::uint64_t ns) noexcept {
    usual_ns_ = (usual_ns_ * (weight - 1) + std::min(ns, slowest * most_ns_)) / weight;
  }

 private:
  static constexpr std::uint64_t weight = 8;
  static constexpr std::uint64_t slowest = 4;  // times `most_ns`: what counts at most

  std::uint64_t most_ns_;
  std::uint64_t usual_ns_;  // a running mean
};

}  // namespace unitylink
