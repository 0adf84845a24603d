// SPDX-License-Identifier: BSD-3-Clause
// ClassicEngine and a device, with all kinds of faults on the wire between them.
#include <algorithm>
#include <array>
#include <vector>

#include "engine_bench.hpp"
#include "virtual_device.hpp"

using namespace unitylink;
using namespace unitylink::test;

// The device counts what it executes, so the test can check the promises. No wrong value is returned. A write that must
// not be repeated is executed at most once. OK means executed. Every request ends. When the faults have stopped, all
// requests succeed again.
TEST_CASE("promises hold on a wire that drops, damages, doubles, truncates and delays") {
  std::uint64_t unknown = 0, failed = 0, good = 0;
  for (std::uint32_t seed = 1; seed <= 150; ++seed) {
    CAPTURE(seed);
    std::mt19937 random(seed);
    const double rate = seed % 5 == 0 ? 0 : std::uniform_real_distribution<>(0, 0.25)(random);
    test::VirtualDevice device({rate, rate, seed % 3 == 0 ? rate / 4 : 0, seed % 2 == 0}, seed);
    EngineBench bench(seed % 4 == 0 ? 16 : 600, 1 + seed % 64);
    bench.engine->configure({.address_bytes = 1,
                             .data_bytes = 4,
                             .read_many = 32,
                             .publish_mode = 2,
                             .base_hz = 1000,
                             .groups = 2,
                             .group_size = 16,
                             .rate_bytes = 2,
                             .discovered = true});
    std::array<std::uint32_t, 8> addresses{};
    for (std::uint32_t index = 0; index < addresses.size(); ++index) {
      addresses[index] = 0x40 + index;
    }
    std::vector<std::array<std::uint32_t, 8>> values(300);
    std::vector<Exchange> exchanges(300);
    for (std::uint32_t index = 0; index < exchanges.size(); ++index) {
      Exchange& exchange = exchanges[index];
      const auto kind = random() % 4;
      exchange = kind == 0   ? writing(0x20, index + 1, false)
                 : kind == 1 ? writing(0x21, index + 1, true)
                             : reading(random() % 256);
      exchange.checked = true;
      exchange.attempts_max = 4;
      if (kind == 3) {
        exchange.operation = Operation::read_many;
        exchange.addresses = std::span(addresses).first(1 + random() % 8);
        exchange.values = values[index];
      }
    }
    std::size_t next = 0;
    std::size_t steps = 0;
    const auto all_done = [&] {
      return next == exchanges.size() &&
             std::all_of(exchanges.begin(), exchanges.end(), [](const Exchange& e) { return e.done(); });
    };
    while (!all_done()) {
      REQUIRE(++steps < 200'000);
      if (next >= exchanges.size() * 4 / 5) {
        device.calm();
      }
      for (auto count = random() % 20; count > 0 && next < exchanges.size(); --count) {
        bench.submit(exchanges[next++]);
      }
      device.receive(bench.sent(), bench.now);
      bench.now =
          std::max(bench.now, std::min(device.next_ns(), bench.engine->next_deadline_ns()) == ClassicEngine::no_deadline
                                  ? bench.now
                                  : std::min(device.next_ns(), bench.engine->next_deadline_ns()));
      const std::string heard = device.take(bench.now);
      for (std::string_view rest = heard; !rest.empty();) {
        const std::size_t size = std::min<std::size_t>(rest.size(), 1 + random() % 30);
        bench.answer(rest.substr(0, size));
        rest.remove_prefix(size);
      }
      bench.engine->advance(bench.now);
    }
    for (std::uint32_t index = 0; index < exchanges.size(); ++index) {
      const Exchange& exchange = exchanges[index];
      CAPTURE(index);
      const bool ok = exchange.status == Status::ok;
      (ok ? good : failed) += 1;
      if (exchange.operation == Operation::read && ok) {
        REQUIRE(exchange.value == test::VirtualDevice::value_at(exchange.address));
      } else if (exchange.operation == Operation::read_many && ok) {
        for (std::size_t word = 0; word < exchange.addresses.size(); ++word) {
          REQUIRE(values[index][word] == test::VirtualDevice::value_at(exchange.addresses[word]));
        }
      } else if (exchange.operation == Operation::write) {
        const int times = device.executed[index + 1];
        if (ok) {
          REQUIRE(times >= 1);
        }
        if (!exchange.repeat) {
          REQUIRE(times <= 1);
          unknown += exchange.status == Status::unknown ? 1 : 0;
          if (exchange.status == Status::timeout) {
            REQUIRE(times == 0);
          }
        }
      }
      if (rate == 0 && seed % 3 != 0) {
        REQUIRE(ok);
      }
    }
    for (std::size_t index = exchanges.size() * 9 / 10 + 20; index < exchanges.size(); ++index) {
      CHECK(exchanges[index].status == Status::ok);  // liveness
    }
  }
  CHECK(unknown > 100);  // the faults had an effect
  CHECK(good > 10 * failed);
}
