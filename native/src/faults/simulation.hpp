// SPDX-License-Identifier: BSD-3-Clause
// One history: an engine, a faulty wire and the twin, until so many messages have been sent. The same seed gives the same history, on every
// machine and however busy it is: `digest` shows it.
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
  // Compiled gateware in place of the twin, with a READWRITE word that begins at 0 for each of a client's words. What it executes is seen by its words: a write
  // that is executed twice with none between them does not show.
  std::function<std::unique_ptr<device::RtlDevice>()> gateware = {};
};

struct Report {
  std::uint64_t messages = 0;        // requests and posts of the clients
  std::uint64_t good = 0;
  std::uint64_t failed = 0;
  std::uint64_t unknown = 0;
  std::uint64_t faults = 0;          // of the wire, resets and pauses
  std::uint64_t resets = 0;
  std::uint64_t sessions = 0;        // framed: opened
  std::uint64_t retries = 0;
  std::uint64_t bus_writes = 0;      // that the device executed
  std::uint64_t undetected = 0;      // classic: damage that its checksum of eight bits let pass; no violation, for it promises no more
  std::uint64_t digest = 0;          // of all that went over the wire and when, and of what the device executed
  double virtual_s = 0;
  double calm_rate_hz = 0;           // messages per second before the faults
  double faulty_rate_hz = 0;
  double recovered_rate_hz = 0;      // from 50 ms after the last fault on
  std::vector<std::string> violations;
};

[[nodiscard]] Report run(const Plan& plan);

}  // namespace unitylink::faults
