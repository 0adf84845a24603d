// SPDX-License-Identifier: BSD-3-Clause
// An SPI slave behind the kernel's spidev: the PC is the master, and each byte it clocks out brings one in.
//   spi:/dev/spidev0.0?speed_hz=10000000&poll=0.001&waiting=/dev/gpiochip0:25
// Options: speed_hz= (of sck, 10 MHz), waiting= (the line on which the slave's wire of that name is), poll= (s between looks at a slave
// that has nothing to say, 0.001; with a line 0.1, in case that the wire is off).
#pragma once

#include <string_view>

#include "layer0_driver/driver.hpp"

namespace unitylink {

// bad_url, not_found, permission, busy, mismatch (a speed, mode or line that is not there). closed once a transfer fails.
[[nodiscard]] Outcome open_spi(const Url& url, std::unique_ptr<Driver>& driver);

// Whether an option of a URL is this driver's.
[[nodiscard]] bool is_spi_option(std::string_view name) noexcept;

}  // namespace unitylink
