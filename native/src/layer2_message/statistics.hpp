// SPDX-License-Identifier: BSD-3-Clause
// The counters of a link since it was opened. They include every byte and message that did not become an answer.
#pragma once

#include <cstdint>

namespace unitylink {

struct Statistics {
  std::uint64_t requests = 0;              // sent, repeats included
  std::uint64_t replies = 0;               // matched to a request, errors of the device included
  std::uint64_t device_errors = 0;         // ?E_xxx among them
  std::uint64_t retries = 0;               // requests sent again
  std::uint64_t timeouts = 0;              // a request or fence had no answer
  std::uint64_t fences = 0;                // resynchronisations sent
  std::uint64_t checksum_errors = 0;       // replies and publishes with a wrong checksum
  std::uint64_t malformed_messages = 0;    // with a head, but of wrong form
  std::uint64_t datalink_errors = 0;       // ?xx from the device
  std::uint64_t stale_replies = 0;         // dropped because no request waited for them (any more)
  std::uint64_t garbage_bytes = 0;         // outside all messages
  std::uint64_t publishes = 0;             // taken into a ring
  std::uint64_t unclaimed_publishes = 0;   // of a group without a subscription
  std::uint64_t mismatched_publishes = 0;  // word count other than the group's
  std::uint64_t overruns = 0;              // publishes overwritten before they were drained
  std::uint64_t bytes_sent = 0;
  std::uint64_t bytes_received = 0;
  std::uint64_t posts = 0;              // framed: writes without an answer that were sent
  std::uint64_t missing_publishes = 0;  // framed: gaps in their sequence
  // framed: sessions opened; more than one: the device was reset, or had another host
  std::uint64_t sessions = 0;
  std::uint64_t restarts = 0;       // framed: sessions that the device had lost
  std::uint64_t reconnections = 0;  // the line was gone, and is back
};

}  // namespace unitylink
