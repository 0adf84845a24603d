// SPDX-License-Identifier: BSD-3-Clause
// FTDI's USB chips without the kernel's serial driver: its latency timer, event character and FIFO modes, and transfers of many packets.
//   ftdi:SERIAL?channel=B&mode=serial&baud=3000000     ftdi:?mode=sync-fifo (the only chip there is)
// Options: channel=A..D (A), mode=serial|fifo|sync-fifo (serial; fifo is the asynchronous FT245 interface), baud= (of serial), latency= (ms, 1),
// event= (the character that sends at once what the chip has gathered; else what ends the messages of the protocol that is spoken; none).
#pragma once

#include <string_view>

#include "layer0_driver/driver.hpp"

namespace unitylink {

// bad_url, not_found, permission, busy. Where the chip cannot be had without the kernel's driver (libusb is missing, no permission), and the mode
// is not sync-fifo, the kernel's serial port of the same chip is opened instead; warning() says so.
[[nodiscard]] Outcome open_ftdi(const Url& url, std::unique_ptr<Driver>& driver);

// Whether an option of a URL is this driver's.
[[nodiscard]] bool is_ftdi_option(std::string_view name) noexcept;

}  // namespace unitylink
