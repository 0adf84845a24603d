// SPDX-License-Identifier: BSD-3-Clause
// Serial ports: raw 8N1 at any baud rate, for one program only, and with low latency if the kernel's driver can. DTR
// and RTS are not changed.
#pragma once

#include "layer0_driver/driver.hpp"

namespace unitylink {

inline constexpr std::uint32_t default_baud_hz = 115200;

// Opens serial:PATH?baud=N. Errors: not_found (also if it is not a serial port), permission, busy (another program
// holds it), bad_url (baud), mismatch (it cannot run at this rate), closed.
Opener open_serial;

namespace detail {

// Sets raw 8N1 at `baud_hz` in both directions. Modem lines are ignored, and not changed at close. Returns 0 or an
// errno.
[[nodiscard]] int make_raw(int descriptor, std::uint32_t baud_hz) noexcept;

}  // namespace detail

}  // namespace unitylink
