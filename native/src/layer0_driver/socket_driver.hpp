// SPDX-License-Identifier: BSD-3-Clause
// TCP and UDP. TCP sends at once (no Nagle). UDP is connected: one datagram per flush, an empty one says goodbye.
#pragma once

#include "layer0_driver/driver.hpp"

namespace unitylink {

// tcp://HOST:PORT or udp://HOST:PORT. not_found (no such host, nothing listens, no route), timeout, closed. A connection is given up as soon
// as `cancelled`, a descriptor, is readable; -1: never.
[[nodiscard]] Outcome open_socket(const Url& url, std::uint64_t timeout_ns, int cancelled, std::unique_ptr<Driver>& driver);

}  // namespace unitylink
