// SPDX-License-Identifier: BSD-3-Clause
// How fast one kind of message gets through: the engine, a wire that loses messages and the twin, on a virtual clock. The same plan gives
// the same rate.
#pragma once

#include <cstdint>

#include "faults/traffic.hpp"

namespace unitylink::faults {

struct GoodputPlan {
  std::uint64_t seed = 1;
  TrafficKind kind = TrafficKind::posts;
  std::uint64_t words = 100'000;     // in all
  std::uint32_t message_words = 1;   // of one message
  double lose = 0;                   // of a message, either way
  std::uint32_t window = protocol::frame::window_default;  // requests in flight, as host and device agree
  std::uint64_t byte_ns = 833;       // 12 MBd
  std::uint64_t delay_ns = 125'000;  // each way: a USB microframe
  std::uint64_t buffer_bytes = 512;  // that wait in front of the line
};

struct GoodputReport {
  double words_per_s = 0;
  double sent_bytes_per_word = 0;    // repeats and questions included
  double returned_bytes_per_word = 0;
  std::uint64_t lost = 0;            // messages
  std::uint64_t wrong = 0;           // words that were not written once (posts: in order) or not read as they are: 0, or the engine is wrong
};

// All messages are handed over as fast as the engine takes them; the time is that until the last one is through. Gives up, with 0
// words_per_s, when none has come through for ten virtual seconds.
[[nodiscard]] GoodputReport goodput(GoodputPlan plan);

}  // namespace unitylink::faults
