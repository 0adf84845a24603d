// SPDX-License-Identifier: BSD-3-Clause
// Serial ports: raw 8N1 at any baud rate, exclusive, low latency where the driver can; DTR and RTS are left alone.
#pragma once

#include "layer0_driver/driver.hpp"

namespace unitylink {

inline constexpr std::uint32_t default_baud_hz = 115200;

// serial:PATH?baud=N. not_found, permission, busy (held by another program), bad_url (baud), closed (not a terminal).
Opener open_serial;

namespace detail {

// Raw 8N1 at `baud_hz` in both directions, modem lines ignored and kept at close; 0 or an errno.
[[nodiscard]] int make_raw(int descriptor, std::uint32_t baud_hz) noexcept;

}  // namespace detail

}  // namespace unitylink
