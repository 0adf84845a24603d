// SPDX-License-Identifier: BSD-3-Clause
// What the system gives, and may refuse: the n-th allocation, the n-th call that moves bytes or waits, the n-th look at the clock.
// This program's own operator new, read, write, send, ppoll and clock_gettime are in front of the system's; until something is armed they pass all on.
#pragma once

#include <cstdint>

namespace unitylink::failing {

enum class What : std::uint8_t { nothing, allocation, transfer, clock };
enum class How : std::uint8_t {
  once,         // of allocations: that one; of the clock: it stands still for a hundred looks
  from_then_on, // of allocations: each of the next hundred; of the clock: an hour has passed
  interrupted,  // of transfers: EINTR
  again,        // EAGAIN
  broken,       // EIO
  nothing,      // 0, as at the end of a file
  one_byte,
};

// The `nth` of what threads do that are not exempt. Not while such threads run.
void arm(What what, How how, std::uint32_t nth) noexcept;
// False: it did not come to it.
bool disarm() noexcept;

// Nothing fails for the thread that holds one.
class Exempt {
 public:
  Exempt() noexcept { ++depth; }
  ~Exempt() { --depth; }
  Exempt(const Exempt&) = delete;
  Exempt& operator=(const Exempt&) = delete;
  static thread_local int depth;
};

}  // namespace unitylink::failing
