// SPDX-License-Identifier: BSD-3-Clause
// poll() with a time in ns, like all times in this library.
#pragma once

#include <cstdint>
#include <ctime>
#include <poll.h>
#include <span>

namespace unitylink {

inline constexpr std::uint64_t for_ever = ~std::uint64_t{0};

// Returns the result of ppoll(): the number of descriptors that are ready, 0 after the time `ns`, or -1 with errno
// after an error or a signal.
inline int poll_for(std::span<pollfd> waiting, std::uint64_t ns) noexcept {
  constexpr std::uint64_t second_ns = 1'000'000'000;
  const timespec time{.tv_sec = static_cast<std::time_t>(ns / second_ns), .tv_nsec = static_cast<long>(ns % second_ns)};
  return ::ppoll(waiting.data(), waiting.size(), ns == for_ever ? nullptr : &time, nullptr);
}

}  // namespace unitylink
