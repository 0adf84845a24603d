// SPDX-License-Identifier: BSD-3-Clause
// The counters of a link since it was opened. They include every byte and message that did not become an answer.
#pragma once

#include <cstdint>

namespace unitylink {

struct Statistics {
  std::uint64_t requests = 0;              // requests sent, with all repeats
  std::uint64_t replies = 0;               // replies to a request, with errors of the device
  std::uint64_t device_errors = 0;         // how many of the replies were ?E_xxx
  std::uint64_t retries = 0;               // requests sent again
  std::uint64_t timeouts = 0;              // a request or fence had no answer
  std::uint64_t fences = 0;                // resynchronisations sent
  std::uint64_t checksum_errors = 0;       // replies and publishes with a wrong checksum
  std::uint64_t malformed_messages = 0;    // messages with a head, but of wrong form
  std::uint64_t datalink_errors = 0;       // ?xx from the device
  std::uint64_t stale_replies = 0;         // replies that were dropped, because no request waited for them (any more)
  std::uint64_t garbage_bytes = 0;         // bytes outside all messages
  std::uint64_t publishes = 0;             // publishes put into a ring
  std::uint64_t unclaimed_publishes = 0;   // publishes of a group without a subscription
  std::uint64_t mismatched_publishes = 0;  // publishes with another number of words than the group
  std::uint64_t overruns = 0;              // publishes overwritten before they were drained
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t posts = 0;              // framed: writes without an answer that were sent
  std::uint64_t missing_publishes = 0;  // framed: publishes lost, as gaps in their sequence show
  // framed: sessions opened; more than one: the device was reset, or had another host
  std::uint64_t sessions = 0;
  std::uint64_t restarts = 0;       // framed: sessions that the device had lost
  std::uint64_t reconnections = 0;  // how often the line was gone and came back
};

}  // namespace unitylink
