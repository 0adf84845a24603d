// SPDX-License-Identifier: BSD-3-Clause
// A node on an RS-485 pair: one serial port, shared by the links of this process to all nodes on it. We are the master.
//   rs485:/dev/ttyUSB0?node=3&baud=3000000
// Options: node= (1 to 63), baud=, poll= (s between looks at a node that has nothing to say, 0.001), silence= (s until a node that was
// polled counts as not there, 0.02).
#pragma once

#include <string_view>

#include "layer0_driver/driver.hpp"

namespace unitylink {

// bad_url, not_found, permission, busy (the port, or a second link to the node), mismatch (another baud rate than the links to other nodes).
[[nodiscard]] Outcome open_rs485(const Url& url, std::unique_ptr<Driver>& driver);

// Whether an option of a URL is this driver's.
[[nodiscard]] bool is_rs485_option(std::string_view name) noexcept;

}  // namespace unitylink
