// SPDX-License-Identifier: BSD-3-Clause
// Robot time waits for the slowest virtual board of a process, but not for ever. The test gives the real time.
#include <doctest/doctest.h>

#include "layer0_driver/robot_time.hpp"
#include "times.hpp"

using unitylink::RobotTime;
using unitylink::test::ms;

namespace {

constexpr std::uint64_t start = 1'000'000 * ms;

}  // namespace

TEST_CASE("robot time is the real one while boards keep up") {
  RobotTime time;
  CHECK(time.now_ns(start) == start);
  RobotTime::Follower one(time);
  RobotTime::Follower other(time);
  for (std::uint64_t at = start; at < start + 100 * ms; at += ms) {
    one.due(at);
    CHECK(time.now_ns(at) == at);
  }
  // a thread that read the real time earlier: robot time does not go back
  CHECK(time.now_ns(start) == start + 99 * ms);
  CHECK(time.now_ns(start + 101 * ms) == start + 101 * ms);
}

TEST_CASE("robot time waits for the slowest board and goes on from there") {
  RobotTime time;
  RobotTime::Follower slow(time);
  RobotTime::Follower quick(time);
  slow.due(start);
  quick.due(start + 50 * ms);
  CHECK(time.now_ns(start + 4 * ms) == start + 4 * ms);
  const std::uint64_t held = start + RobotTime::lag_together_ns;
  CHECK(time.now_ns(start + 30 * ms) == held);
  CHECK(time.now_ns(start + 60 * ms) == held);
  slow.due(start + 2 * ms);
  CHECK(time.now_ns(start + 60 * ms) == held);  // robot time that was lost is not made up for
  CHECK(time.now_ns(start + 61 * ms) == held + ms);
  CHECK(time.now_ns(start + 70 * ms) == held + 2 * ms);
  slow.due(RobotTime::idle);
  CHECK(time.now_ns(start + 80 * ms) == held + 12 * ms);
}

TEST_CASE("a board alone may catch up") {
  RobotTime time;
  RobotTime::Follower board(time);
  board.due(start);
  CHECK(time.now_ns(start + 90 * ms) == start + 90 * ms);
  CHECK(time.now_ns(start + 150 * ms) == start + RobotTime::lag_alone_ns);
}

TEST_CASE("a board that stands still is waited for no longer than it takes to be sure, and its end frees the others") {
  RobotTime time;
  RobotTime::Follower other(time);
  {
    RobotTime::Follower stuck(time);
    stuck.due(start);
    const std::uint64_t held = start + RobotTime::lag_together_ns;
    CHECK(time.now_ns(start + 10 * ms) == held);
    CHECK(time.now_ns(start + 9 * ms + RobotTime::patience_ns) == held);
    CHECK(time.now_ns(start + 10 * ms + RobotTime::patience_ns) == held + ms);
    stuck.due(start);  // this board still makes no progress
    CHECK(time.now_ns(start + 20 * ms + RobotTime::patience_ns) == held + 11 * ms);
    stuck.due(start + ms);
    CHECK(time.now_ns(start + 30 * ms + RobotTime::patience_ns) == held + 11 * ms);
  }
  CHECK(time.now_ns(start + 40 * ms + RobotTime::patience_ns) == start + RobotTime::lag_together_ns + 21 * ms);
}
