// SPDX-License-Identifier: BSD-3-Clause
// The publish groups of the board, and who gets their publishes. Equal definitions of several clients, and of a
// listener in this program, share one group, so the line carries each publish once.
#pragma once

#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "layer2_message/link.hpp"

namespace unitylink::server {

class Session;

class FanOut {
 public:
  struct Reader {
    Session* session = nullptr;
    std::uint32_t group = 0;  // as the client numbers it

    friend bool operator==(const Reader&, const Reader&) = default;
  };
  struct Definition {
    std::vector<std::uint32_t> addresses;
    std::uint32_t divisor = 0;
    bool on_event = false;
    std::optional<std::uint32_t> group;  // of the board, if its event input matters

    friend bool operator==(const Definition&, const Definition&) = default;
  };

  // Who calls holds `mutex`. It is free while the board is waited for, and nobody else changes the groups then.
  FanOut(Link& link, std::mutex& mutex) noexcept : link_(link), mutex_(mutex) {}

  // mismatch: the board has no group left. Other failures: it did not answer.
  [[nodiscard]] Outcome add(const Reader& reader, Definition definition);
  void remove(const Reader& reader);
  void remove(const Session& session);
  // As add(), without verifying an address. Keeps up to `ring` publishes in the link, for a listener in this program:
  // Link::drain(subscription).
  [[nodiscard]] Outcome listen(Definition definition, std::size_t ring, std::uint32_t& subscription);
  [[nodiscard]] Outcome hush(std::uint32_t subscription);
  // Who gets the publishes of this group of the board.
  [[nodiscard]] std::span<const Reader> readers(std::uint32_t group) const noexcept;
  [[nodiscard]] std::size_t groups() const noexcept { return groups_.size(); }

 private:
  struct Group {
    Definition definition;
    std::uint32_t subscription = 0;
    std::vector<Reader> readers;
    bool heard = false;  // by a listener
  };

  [[nodiscard]] Outcome open(Group group, std::size_t ring);  // of which nothing is kept if nobody listens
  Outcome close_unread();

  Link& link_;
  std::mutex& mutex_;
  std::vector<Group> groups_;
};

}  // namespace unitylink::server
