// SPDX-License-Identifier: BSD-3-Clause
// One request to the board in the name of a client, and what the client gets of its answer.
#pragma once

#include <cstdint>
#include <vector>

#include "layer2_message/exchange.hpp"

namespace unitylink::server {

class Session;
class Upstream;

// A frame of a client that is not executed yet.
struct Waiting {
  std::uint8_t kind = 0;
  std::vector<std::uint8_t> payload;
};

// A client that gets the answer of another one's errand, too.
struct Joined {
  Session* session = nullptr;
  std::uint16_t id = 0;
};

struct Errand {
  Exchange exchange;
  std::vector<std::uint8_t> body;
  std::vector<std::uint8_t> answer;
  Upstream* home = nullptr;
  Session* session = nullptr;           // nullptr: the client is gone, and nobody waits for the answer
  std::uint8_t operation = 0;           // the kind that the client has sent
  std::uint16_t id = 0;                 // the client's
  std::uint32_t address = 0;            // read_control: the first register; exchange: the group
  bool shareable = false;               // a read without side effect: an equal one may join it before it is sent
  std::vector<Joined> joined;           // who has joined it
  std::vector<Waiting> posts;           // the posts that it carries, if it carries posts
  std::vector<std::size_t> post_words;  // words of each of them

  // This session does not wait any more. False: nobody does.
  [[nodiscard]] bool drop(const Session& gone) {
    std::erase_if(joined, [&gone](const Joined& other) { return other.session == &gone; });
    if (session == &gone) {
      session = nullptr;
      if (!joined.empty()) {
        session = joined.front().session;
        id = joined.front().id;
        joined.erase(joined.begin());
      }
    }
    return session != nullptr;
  }
  // Whether the board has answered. Else nobody knows what it did.
  [[nodiscard]] bool answered() const noexcept {
    const bool told = exchange.status == Status::ok || exchange.status == Status::bus_error ||
                      exchange.status == Status::denied || exchange.status == Status::protocol_error ||
                      exchange.status == Status::refused || exchange.status == Status::lease_held;
    return told && exchange.reply_status != Exchange::no_reply;
  }
};

}  // namespace unitylink::server
