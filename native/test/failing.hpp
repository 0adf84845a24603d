// SPDX-License-Identifier: BSD-3-Clause
// What the system gives, and may refuse: the n-th allocation, the n-th call that moves bytes or waits, the n-th that
// opens something or sets it up, the n-th look at the clock. This program's own malloc, read, open and so on are in
// front of the system's; until something is armed they pass all on.
#pragma once

#include <cstdint>

namespace unitylink::failing {

enum class What : std::uint8_t {
  nothing,
  allocation,  // malloc, calloc, realloc: also those of the C library itself (a sanitizer has its own malloc: there
               // operator new)
  transfer,    // read, write, send, ppoll
  opening,     // open, socket, connect, eventfd, fcntl, ioctl, flock, isatty, fstat, getsockopt, setsockopt, mmap of a
               // file, a thread
  clock,
};
enum class How : std::uint8_t {
  once,          // of allocations: that one; of the clock: it stands still for a hundred looks
  from_then_on,  // of allocations: each of the next hundred; of the clock: an hour has passed
  interrupted,   // of transfers and openings: EINTR
  again,         // EAGAIN
  broken,        // EIO
  none_left,     // EMFILE
  nothing,       // 0, as at the end of a file
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
