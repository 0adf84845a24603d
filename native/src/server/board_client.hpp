// SPDX-License-Identifier: BSD-3-Clause
// A client of a board server: its connection and its session. Only the files of BoardServer use it.
#pragma once

#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <utility>

#include "server/board_server.hpp"

namespace unitylink::server {

struct BoardServer::Client {
  Client(Host& host, Connection taken, std::string called, std::uint32_t user, Grant grant, std::uint64_t number,
         std::uint64_t now_ns)
      : connection(std::move(taken)),
        name(std::move(called)),
        id(number),
        since_ns(real_ns()),
        session(host, std::move(grant), static_cast<std::uint16_t>(std::random_device()()), now_ns, user) {}

  Connection connection;
  std::string name;
  std::uint64_t id;
  std::uint64_t since_ns;
  Session session;
  std::uint32_t watched = 0;   // events of epoll
  std::uint64_t stuck_ns = 0;  // since when it has taken nothing of what waits for it; 0: nothing waits
  std::optional<Decision> decided;
  bool gone = false;
  bool silent = false;  // it did not take what was sent
};

}  // namespace unitylink::server
