// SPDX-License-Identifier: BSD-3-Clause
// How a call ended. The numbers are the same as ul_status in the C ABI. Python has one exception class for each
// failure.
#pragma once

#include <cstdint>
#include <string>
#include <utility>

namespace unitylink {

enum class Status : std::int32_t {
  ok = 0,
  timeout = 1,         // the device did not answer in time
  unknown = 2,         // sent, but the answer was lost: it may or may not have been executed
  closed = 3,          // the port is closed, gone, or was unplugged
  busy = 4,            // another program holds the port or the board
  not_found = 5,       // no such port, host or file
  permission = 6,      // the operating system refuses the port
  bus_error = 7,       // the device's bus refused or did not answer the address
  protocol_error = 8,  // the device broke the protocol, or refused the command
  mismatch = 9,        // the device cannot do what is asked
  range = 10,          // a value, address or count that cannot be sent; nothing was sent
  bad_url = 11,        // a link URL that cannot be understood
  cancelled = 12,      // another request of the same call failed: this one was not sent, or its read was given up
  denied = 15,         // the dead-man has tripped: no write is executed before arm(). (Only the C ABI has 13 and 14.)
  down = 16,           // the line is gone and is being opened again; nothing was sent
  refused = 17,        // a server does not let this client do that; nothing was sent to the board
  lease_held = 18,     // another client of the server has the write lease; nothing was sent to the board
};

[[nodiscard]] const char* status_text(Status status) noexcept;

// The result of a call: its status and, after a failure, all that helps a user to understand it.
struct Outcome {
  Status status = Status::ok;
  std::string text;  // names the item and the remedy; empty if the status is ok
  bool has_address = false;
  std::uint32_t address = 0;     // the word address of the failure
  std::uint32_t index = 0;       // the number of the failed request within a vector call
  std::uint32_t attempts = 0;    // how often an answer was requested
  std::uint64_t elapsed_ns = 0;  // from the first attempt to the failure

  Outcome() = default;
  Outcome(Status how, std::string why) : status(how), text(std::move(why)) {}
  [[nodiscard]] bool ok() const noexcept { return status == Status::ok; }
};

}  // namespace unitylink
