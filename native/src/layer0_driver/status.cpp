// SPDX-License-Identifier: BSD-3-Clause
#include "layer0_driver/status.hpp"

namespace unitylink {

const char* status_text(Status status) noexcept {
  switch (status) {
    case Status::ok: return "ok";
    case Status::timeout: return "the device did not answer in time";
    case Status::unknown: return "sent, but the answer was lost: it may or may not have been executed";
    case Status::closed: return "the port is closed, gone, or was unplugged";
    case Status::busy: return "another program holds the port or the board";
    case Status::not_found: return "there is no such port, host or file";
    case Status::permission: return "the operating system refuses access to the port";
    case Status::bus_error: return "the device's bus refused the address or did not answer";
    case Status::protocol_error: return "the device refused the command or answered outside the protocol";
    case Status::mismatch: return "the device cannot do what is asked";
    case Status::range: return "a value, address or count that cannot be sent";
    case Status::bad_url: return "a link URL that cannot be understood";
    case Status::cancelled: return "given up, because another request of the same call failed";
    case Status::denied: return "the device's dead-man has tripped, and it writes nothing before it is armed again";
    case Status::refused: return "the server does not allow that; nothing was sent to the board";
    case Status::lease_held: return "another client has the write lease; nothing was sent to the board";
    case Status::down: return "the line is gone, and is being opened again";
  }
  return "no such status";
}

}  // namespace unitylink
