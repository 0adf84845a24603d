// SPDX-License-Identifier: BSD-3-Clause
// What a client thinks about the clock of its server is never too early, and never later than its questions allow.
#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "layer2_message/server_clock.hpp"

using unitylink::ServerClock;

TEST_CASE("the latest time of a server's clock is right whatever the delays and the drift are") {
  constexpr double second_ns = 1e9;
  for (unsigned seed = 0; seed < 200; ++seed) {
    std::mt19937 chance(seed);
    const auto uniform = [&](double from, double to) { return std::uniform_real_distribution(from, to)(chance); };
    const double rate = 1 + uniform(-190e-6, 190e-6);
    const double offset_us = uniform(0, 8e9);  // it also passes the end of 32 bits
    const auto server_us = [&](double at_ns) { return offset_us + rate * at_ns / 1000; };
    ServerClock clock;
    CHECK_FALSE(clock.latest_us(0).has_value());
    double now_ns = uniform(0, 100) * second_ns;
    double shortest_us = 1e18;
    for (int question = 0; question < 20; ++question) {
      const double asked_ns = now_ns;
      const double told_ns = asked_ns + uniform(0, 2) * second_ns;
      now_ns = told_ns + uniform(0, 2) * second_ns;
      clock.learn(static_cast<std::uint32_t>(static_cast<std::uint64_t>(server_us(told_ns))),
                  static_cast<std::uint64_t>(asked_ns));
      const double drifted_us = 400e-6 * (now_ns - asked_ns) / 1000;
      shortest_us = std::min(shortest_us, server_us(told_ns) - server_us(asked_ns)) + drifted_us;
      const double at_ns = std::max(0.0, asked_ns + uniform(-10, 4) * second_ns);
      const auto truth_us = static_cast<std::uint32_t>(static_cast<std::uint64_t>(server_us(at_ns)));
      const auto late_us = static_cast<std::int32_t>(*clock.latest_us(static_cast<std::uint64_t>(at_ns)) - truth_us);
      CHECK(late_us >= 0);
      CHECK(late_us <= shortest_us + 10'000);
      now_ns += uniform(0, 600) * second_ns;
      shortest_us += 400e-6 * 600 * 1e6;
    }
    clock.forget();
    CHECK_FALSE(clock.latest_us(0).has_value());
  }
}
