// SPDX-License-Identifier: BSD-3-Clause
// Where a board can be reached. It has one client at a time, and a second one receives "?busy".
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

#include "layer0_driver/lockstep.hpp"

namespace unitylink::device {

// The endpoint cannot be made. The message gives what was requested, the reason, and the remedy.
class EndpointError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// After construction, only the board's thread uses it. Nothing here blocks.
class Endpoint {
 public:
  // gone: the client has left, and the endpoint is free again
  enum class Result : std::uint8_t { done, nothing, gone };
  struct Transfer {
    Result result = Result::nothing;
    std::size_t bytes = 0;
  };

  virtual ~Endpoint() = default;
  Endpoint() = default;
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  // The URL for a link. A descriptor belongs to the link from then on. After that link has left, there is a new one.
  virtual std::string url() = 0;
  [[nodiscard]] virtual bool has_client() const noexcept = 0;
  // The descriptors to poll, or -1. `listener` becomes readable when a client wants to connect.
  [[nodiscard]] virtual int client() const noexcept = 0;
  [[nodiscard]] virtual int listener() const noexcept { return -1; }
  // Looks for a new client, and returns true if one has come. `at_rest`: no half message is being sent.
  virtual bool admit(bool at_rest) = 0;
  // True if a client can come without a readable descriptor. Then admit() must be called every few milliseconds.
  [[nodiscard]] virtual bool must_look() const noexcept { return false; }
  // True after the client has ended its sending. It may still read, and `receive` then only finds out that it has left.
  [[nodiscard]] virtual bool ended() const noexcept { return false; }
  // Touches `member` whenever there is something to admit, to receive, or room to send. False: this endpoint has
  // descriptors to poll instead.
  virtual bool listen(Lockstep::Member*) { return false; }
  // Dismisses the client. A terminal cannot do this.
  virtual void dismiss() {}
  virtual Transfer receive(std::span<std::uint8_t> room) = 0;
  virtual Transfer send(std::span<const std::uint8_t> bytes) = 0;
};

// `kind` is "fd", "lockstep", "pty[:PATH]", "tcp[:PORT]" or "udp[:PORT]". `bind` is the local address for the last two.
// Throws EndpointError.
std::unique_ptr<Endpoint> make_endpoint(const std::string& kind, const std::string& bind);

}  // namespace unitylink::device
