// SPDX-License-Identifier: BSD-3-Clause
// A moment from which on what a thread asks is not sent: first, or again. So a value whose time is over does not reach
// the device, wherever its program was held up.
#pragma once

#include <cstdint>
#include <utility>

namespace unitylink {

namespace detail {
inline thread_local std::uint64_t send_before_ns = 0;
}

// The limit of this thread, by real_ns(). 0: none. It counts for the requests of framed links that are made from now
// on.
[[nodiscard]] inline std::uint64_t sending_limit() noexcept { return detail::send_before_ns; }
// Sets it, and returns the one until now.
inline std::uint64_t limit_sending(std::uint64_t before_ns) noexcept {
  return std::exchange(detail::send_before_ns, before_ns);
}

}  // namespace unitylink
