// SPDX-License-Identifier: BSD-3-Clause
// Where clients come in. It listens, and takes the login line of each (layer0_driver/login.hpp). It decides nothing:
// the caller gets each login, and admits or refuses it.
//
// With TLS it takes the login only behind the handshake. A client that says nothing, too much or something else is gone
// after `patience_ns`. At most `knocking_most` may be at the door at once. The others wait in the queue of the
// operating system.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "layer0_driver/descriptor.hpp"
#include "layer0_driver/login.hpp"
#include "layer0_driver/status.hpp"
#include "layer0_driver/tls.hpp"
#include "server/connection.hpp"

namespace unitylink::server {

// A client at the door, which waits for an answer.
struct Knock {
  Connection connection;
  std::string peer;         // "HOST:PORT"
  std::string certificate;  // the name in the certificate that it has shown; empty: none
  Login login;
};

class Door {
 public:
  static constexpr std::uint64_t patience_ns = 3'000'000'000;
  static constexpr std::size_t knocking_most = 64;

  // Listens at HOST:PORT. Port 0 takes a free one. Without `side` nothing is encrypted. not_found: no such address;
  // busy: another program has the port.
  [[nodiscard]] static Outcome open(const std::string& host, std::uint16_t port, std::shared_ptr<const tls::Side> side,
                                    std::optional<Door>& door);
  Door(Door&&) = default;

  [[nodiscard]] const std::string& place() const noexcept { return place_; }  // "HOST:PORT"
  // Waits for a complete login. Empty: none came in this time.
  [[nodiscard]] std::optional<Knock> wait(std::uint64_t timeout_ns);
  // Tells the client, and closes its connection.
  static void refuse(Knock knock, const std::string& reason, const std::string& text);
  // Tells the client, and returns its connection, ready for frames.
  [[nodiscard]] static Connection admit(Knock knock, const std::string& text);
  // Clients that were turned away here: too slow, or no login.
  [[nodiscard]] std::uint64_t turned_away() const noexcept { return turned_away_; }

 private:
  struct Caller {
    Connection connection;
    std::string peer;
    std::string line;
    std::uint64_t until_ns = 0;
    bool shaken = true;       // the handshake of TLS is over
    bool wants_room = false;  // it waits until the socket takes more
  };

  Door(Descriptor listener, std::string place, std::shared_ptr<const tls::Side> side)
      : listener_(std::move(listener)), place_(std::move(place)), side_(std::move(side)) {}
  void let_in();
  [[nodiscard]] bool shake(Caller& caller);
  void turn_away(Caller& caller, const std::string& text);
  [[nodiscard]] std::optional<Knock> hear(Caller& caller);

  Descriptor listener_;
  std::string place_;
  std::shared_ptr<const tls::Side> side_;
  std::vector<Caller> callers_;
  std::uint64_t turned_away_ = 0;
};

}  // namespace unitylink::server
