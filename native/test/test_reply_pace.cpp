// SPDX-License-Identifier: BSD-3-Clause
// How long a caller checks for its reply before it sleeps.
#include <doctest/doctest.h>

#include "layer2_message/reply_pace.hpp"

using unitylink::ReplyPace;

TEST_CASE("a caller looks for its reply only where replies come soon") {
  ReplyPace pace(200'000);
  CHECK(pace.look_ns() == 0);  // no reply was measured yet
  for (int reply = 0; reply < 30; ++reply) {
    pace.waited(40'000);
  }
  CHECK(pace.look_ns() == 200'000);
  pace.waited(50'000'000);  // one late reply
  CHECK(pace.look_ns() == 200'000);
  for (int reply = 0; reply < 4; ++reply) {
    pace.waited(1'000'000);
  }
  CHECK(pace.look_ns() == 0);
}

TEST_CASE("spin=0 never looks") {
  ReplyPace pace(0);
  for (int reply = 0; reply < 30; ++reply) {
    pace.waited(0);
  }
  CHECK(pace.look_ns() == 0);
}
