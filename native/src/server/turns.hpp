// SPDX-License-Identifier: BSD-3-Clause
// The errands that wait for the line to the board. Users have their turns one after the other, each with one errand. So
// before an errand that is the first of its user, at most one errand of each other user is sent. The clients of a user
// have his turns one after the other. So a user who opens many connections gets no more than one who opens one.
//
// A read that equals one that waits here joins it: the board is asked once, and answers both. It is asked after both
// clients have asked, so neither gets a value that was sampled before.
#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "server/errand.hpp"

namespace unitylink::server {

class Turns {
 public:
  // Takes an errand in. If it joins another one, it is left empty for the caller to recycle: false.
  [[nodiscard]] bool add(Errand& errand);
  [[nodiscard]] bool empty() const noexcept { return users_.empty(); }
  [[nodiscard]] std::size_t waiting() const noexcept { return waiting_; }
  // The next errand to send. There must be one.
  [[nodiscard]] Errand& next();
  // The session does not wait any more. Errands for which nobody waits are appended to `idle`.
  void leave(const Session& session, std::vector<Errand*>& idle);
  // Reads that have joined another one.
  [[nodiscard]] std::uint64_t joined() const noexcept { return joined_; }

 private:
  struct Line {
    const Session* session;
    std::deque<Errand*> errands;
  };

  struct User {
    std::uint32_t number;
    std::deque<Line> lines;
  };

  // One that waits, and that the board may answer for this one, too. nullptr: none.
  [[nodiscard]] Errand* equal(const Errand& errand) const noexcept;

  std::deque<User> users_;  // both in the order of their turns; none is empty
  std::size_t waiting_ = 0;
  std::uint64_t joined_ = 0;
};

}  // namespace unitylink::server
