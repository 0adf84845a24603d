// SPDX-License-Identifier: BSD-3-Clause
// Lets the n-th call of a certain kind fail: an allocation, a call that moves bytes or waits, a call that opens
// something or sets it up, or a clock reading. This program has its own malloc, read, open and so on, which call those
// of the system. Nothing fails until something is armed.
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
  once,          // an allocation: only that one; the clock: it stands still for a hundred readings
  from_then_on,  // an allocation: that one and the next 99; the clock: it jumps by an hour
  interrupted,   // transfers and openings: EINTR
  again,         // EAGAIN
  broken,        // EIO
  none_left,     // EMFILE
  nothing,       // result 0, as at the end of a file
  one_byte,
};

// The `nth` such call of all threads that are not exempt will fail. Do not call it while such threads run.
void arm(What what, How how, std::uint32_t nth) noexcept;
// False: there were fewer such calls.
bool disarm() noexcept;

// As long as a thread has one of these, none of its calls fail.
class Exempt {
 public:
  Exempt() noexcept { ++depth; }
  ~Exempt() { --depth; }
  Exempt(const Exempt&) = delete;
  Exempt& operator=(const Exempt&) = delete;
  static thread_local int depth;
};

}  // namespace unitylink::failing
