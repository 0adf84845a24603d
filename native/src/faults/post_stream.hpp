// SPDX-License-Identifier: BSD-3-Clause
// How fast posts arrive: the engine, a wire that loses messages and the twin, on a virtual clock. The same plan gives the same rate.
#pragma once

#include <cstdint>

namespace unitylink::faults {

struct PostPlan {
  std::uint64_t seed = 1;
  std::uint64_t posts = 100'000;     // words
  std::uint32_t words = 1;           // of one message
  double lose = 0;                   // of a message, either way
  std::uint64_t byte_ns = 833;       // 12 MBd
  std::uint64_t delay_ns = 125'000;  // each way: a USB microframe
  std::uint64_t buffer_bytes = 512;  // that wait in front of the line
};

struct PostReport {
  double posts_per_s = 0;
  double sent_bytes_per_post = 0;    // repeats and questions included
  std::uint64_t lost = 0;            // messages
  std::uint64_t disorder = 0;        // words that were not written in order, once: 0, or the engine is wrong
};

// All posts are made as fast as the engine takes them; the time is that until the last one has been executed. Gives up, with 0
// posts_per_s, when nothing has been executed for ten virtual seconds.
[[nodiscard]] PostReport stream_posts(PostPlan plan);

}  // namespace unitylink::faults
