// SPDX-License-Identifier: BSD-3-Clause
// Where a board can be reached: one client at a time, a second opener hears "?busy".
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <stdexcept>
#include <string>

namespace unitylink::device {

// The endpoint cannot be made: the message says what was asked for, why not, and what to do.
class EndpointError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Used by the board's thread only, after construction. Nothing here blocks.
class Endpoint {
 public:
  enum class Result : std::uint8_t { done, nothing, gone };  // gone: the client has left; the endpoint is free again
  struct Transfer {
    Result result = Result::nothing;
    std::size_t bytes = 0;
  };

  virtual ~Endpoint() = default;
  Endpoint() = default;
  Endpoint(const Endpoint&) = delete;
  Endpoint& operator=(const Endpoint&) = delete;

  // What a link connects to. A descriptor is the link's from then on; once that link has left there is a new one.
  virtual std::string url() = 0;
  [[nodiscard]] virtual bool has_client() const noexcept = 0;
  // The descriptors to poll; -1 for none. `listener` becomes readable when someone wants in.
  [[nodiscard]] virtual int client() const noexcept = 0;
  [[nodiscard]] virtual int listener() const noexcept { return -1; }
  // Looks for a new client: true if there is one now that was not there before. `at_rest`: no half message is on its way.
  virtual bool admit(bool at_rest) = 0;
  // True when a client can come without any descriptor becoming readable: admit() must be called every few milliseconds.
  [[nodiscard]] virtual bool must_look() const noexcept { return false; }
  // True when the client has said that it sends no more, and may still read: `receive` then only finds out that it is gone.
  [[nodiscard]] virtual bool ended() const noexcept { return false; }
  // Lets the client go; a terminal cannot.
  virtual void dismiss() {}
  virtual Transfer receive(std::span<std::uint8_t> room) = 0;
  virtual Transfer send(std::span<const std::uint8_t> bytes) = 0;
};

// `kind` is "fd", "pty[:PATH]", "tcp[:PORT]" or "udp[:PORT]"; `bind` the local address for the last two.
// Throws EndpointError.
std::unique_ptr<Endpoint> make_endpoint(const std::string& kind, const std::string& bind);

}  // namespace unitylink::device
