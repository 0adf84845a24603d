// SPDX-License-Identifier: BSD-3-Clause
// One history: an engine, a faulty wire and the twin, until so many messages were sent. The same seed gives the same
// history, on every machine and however busy it is. `digest` shows it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "faults/profile.hpp"

namespace unitylink::device {
class RtlDevice;
}

namespace unitylink::faults {

struct Plan {
  std::uint64_t seed = 1;
  std::uint64_t messages = 10'000;
  Profile profile;
  bool framed = true;
  std::uint32_t clients = 16;
  std::uint32_t window = 32;  // requests in flight, a power of two
  // Makes compiled gateware, which is used instead of the twin. It needs a READWRITE word with the first value 0 for
  // each word of a client. An execution is visible only as a change of a word. So a write is not detected as executed
  // twice if no other write came in between.
  std::function<std::unique_ptr<device::RtlDevice>()> gateware = {};
};

struct Report {
  std::uint64_t messages = 0;  // requests and posts of the clients
  std::uint64_t good = 0;
  std::uint64_t failed = 0;
  std::uint64_t unknown = 0;
  std::uint64_t faults = 0;  // faults of the wire, resets and pauses
  std::uint64_t resets = 0;
  std::uint64_t sessions = 0;  // framed: sessions opened
  std::uint64_t retries = 0;
  std::uint64_t bus_writes = 0;  // writes that the device executed
  // classic: damage that the eight-bit checksum missed; not a violation, because more is not promised
  std::uint64_t undetected = 0;
  std::uint64_t digest = 0;  // hash of all bytes on the wire with their times, and of the device's writes
  double virtual_s = 0;
  double calm_rate_hz = 0;  // messages per second before the faults
  double faulty_rate_hz = 0;
  double recovered_rate_hz = 0;  // messages per second from 50 ms after the last fault on
  std::vector<std::string> violations;
};

[[nodiscard]] Report run(const Plan& plan);

}  // namespace unitylink::faults
