// SPDX-License-Identifier: BSD-3-Clause
// How fast one kind of message gets through: the engine, a wire that loses messages, and the twin, on a virtual clock.
// The same plan gives the same rate.
#pragma once

#include <cstdint>

#include "faults/traffic.hpp"

namespace unitylink::faults {

struct GoodputPlan {
  std::uint64_t seed = 1;
  TrafficKind kind = TrafficKind::posts;
  std::uint64_t words = 100'000;                           // in all
  std::uint32_t message_words = 1;                         // words of one message
  double lose = 0;                                         // share of lost messages, in each direction
  std::uint32_t window = protocol::frame::window_default;  // most requests in flight
  std::uint64_t byte_ns = 833;                             // 12 MBd
  std::uint64_t delay_ns = 125'000;                        // in each direction: a USB microframe
  std::uint64_t buffer_bytes = 512;                        // bytes that the host can queue for the line
};

struct GoodputReport {
  double words_per_s = 0;
  double sent_bytes_per_word = 0;  // including repeats and questions
  double returned_bytes_per_word = 0;
  std::uint64_t lost = 0;   // messages
  std::uint64_t wrong = 0;  // words not written exactly once (posts: in order), or read wrongly; must be 0
};

// Gives the engine all messages as fast as it takes them, and measures the time until the last one is through. If none
// gets through for ten virtual seconds, it gives up, with words_per_s = 0.
[[nodiscard]] GoodputReport goodput(GoodputPlan plan);

}  // namespace unitylink::faults
