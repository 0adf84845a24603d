// SPDX-License-Identifier: BSD-3-Clause
// The twin of the 2012 gateware with its defects, and the host, which must work with them. tests/conformance replays
// the recordings, which contain some of the defects.
#include <array>
#include <deque>
#include <random>

#include "device_bench.hpp"
#include "engine_bench.hpp"
#include "layer2_message/failure.hpp"

using namespace unitylink;
using namespace unitylink::test;
using device::DeviceConfiguration;
using device::test::DeviceBench;

namespace {

DeviceConfiguration gateware_2012() {
  DeviceConfiguration configuration = device::test::bench();
  configuration.published_2012 = true;
  configuration.protocol = device::Protocol::classic;
  return configuration;
}

DeviceConfiguration silent_at_0() {
  DeviceConfiguration configuration = gateware_2012();
  configuration.silent_ranges.push_back({0, 0});
  return configuration;
}

// An engine and a device that exchange their bytes, on the device's clock.
struct OldWire {
  explicit OldWire(const DeviceConfiguration& configuration, std::uint32_t fifo = 64, bool checksums = true)
      : device(configuration) {
    EngineSettings settings;
    settings.receive_fifo_bytes = settings.transmit_fifo_bytes = fifo;
    settings.checksums = checksums;
    settings.timeout_ns = 2 * ms;
    engine = std::make_unique<ClassicEngine>(settings);
    Exchange first;
    first.operation = Operation::resynchronise;
    engine->submit(first, now());
    run();
    REQUIRE(first.status == Status::ok);
    REQUIRE(engine->reported());
    engine->configure(*engine->reported());
  }

  [[nodiscard]] std::uint64_t now() const { return 1000 * ms + device.clock() * 20; }

  void submit(Exchange& exchange) { engine->submit(exchange, now()); }

  // Runs until neither side has anything more to do.
  void run() {
    for (unsigned quiet = 0; quiet < 2;) {
      const std::span<const std::uint8_t> bytes = engine->transmit(now());
      std::size_t taken = 0;
      while (taken < bytes.size() && device.receive(bytes[taken])) {
        sent.push_back(static_cast<char>(bytes[taken++]));
      }
      engine->sent(taken);
      device.run_until(device.clock() + 500);
      device::TimedByte byte;
      std::string text;
      while (device.take(byte)) {
        text.push_back(static_cast<char>(byte.byte));
      }
      engine->receive(bytes_of(text), now());
      engine->advance(now());
      const bool waits = engine->next_deadline_ns() != Engine::no_deadline;
      quiet = taken > 0 || !text.empty() || waits ? 0 : quiet + 1;
    }
  }

  void run(Exchange& exchange) {
    submit(exchange);
    run();
    REQUIRE(exchange.done());
  }

  [[nodiscard]] std::uint32_t memory(std::uint32_t address) { return device.get(address).value; }

  device::Device device;
  std::unique_ptr<ClassicEngine> engine;
  std::string sent;
};

std::string told(const Exchange& exchange) {
  return describe(exchange, {.address_bytes = 1, .last_answer_ns = 1, .reason = {}}).text;
}

}  // namespace

TEST_CASE("2012: a byte directly behind an error of form or checksum is swallowed, if it has come") {
  for (const char* wrong : {"$R:12*00\n", "#R:1\n", "#R:12*", "#R:1#"}) {
    CAPTURE(wrong);
    DeviceBench old(gateware_2012());
    const std::string alone = old.ask(wrong);
    CHECK(alone.starts_with("?f"));
    CHECK(old.ask("\n#R:12\n") == "#S_R:40de1212\n");  // this byte came later
    CHECK(old.ask(std::string(wrong) + "#R:12\n") == alone);
    CHECK(DeviceBench().ask(std::string(wrong) + "#R:12\n") == alone + "#S_R:40de1212\n");
  }
  CHECK(DeviceBench(gateware_2012()).ask("#R:1G#R:12\n") == "?f3\n#S_R:40de1212\n");  // not after this kind of error
}

TEST_CASE("2012: the replies to requests that came later overtake the report of an overrun") {
  const auto answered_before_report = [](const DeviceConfiguration& configuration, device::Clock at) {
    DeviceBench bench(configuration);
    bench.put("#R:10\n#R:11\n#R:12\n#R:13\n#R:14\n#R:15\n");
    bench.device.run_until(at);
    bench.device.receive_error(4);
    const std::string answers = bench.wait(2000);
    REQUIRE(answers.find("?f9\n") != std::string::npos);
    return answers.find("?f9\n") / std::string_view("#S_R:40de1010\n").size();
  };
  std::size_t old = 0;
  std::size_t corrected = 0;
  for (device::Clock at = 1; at <= 200; ++at) {
    old += answered_before_report(gateware_2012(), at);
    corrected += answered_before_report(device::test::bench(), at);
  }
  CHECK(old > corrected);
}

TEST_CASE("2012: a rate of 0 leaves the publish that is pending") {
  for (const bool old : {true, false}) {
    CAPTURE(old);
    DeviceConfiguration configuration = old ? gateware_2012() : device::test::bench();
    configuration.base_hz = 100'000;  // a strobe every 500 clocks
    unsigned published = 0;
    // at some moments a strobe comes while the rate is written
    for (device::Clock moment = 0; moment < 500; moment += 20) {
      DeviceBench bench(configuration);
      CHECK(bench.ask("#WSA:000110\n#WSR:000001\n#EPS\n", 1000).starts_with("#S_WSA\n#S_WSR\n#S_EPS\n"));
      bench.wait(moment);
      const std::string text = bench.ask("#RM:10101112131415161718191A1B1C1D1E1F\n#WSR:000000\n", 5000);
      REQUIRE(text.find("#S_WSR\n") != std::string::npos);
      const std::string behind = text.substr(text.find("#S_WSR\n"));
      published += behind.find("%PUB:000140de1010\n") != std::string::npos ? 1 : 0;
      CHECK(behind.find("%PUB") == behind.rfind("%PUB"));  // at most one
    }
    CHECK((published > 0) == old);
  }
}

TEST_CASE("2012: the words of writes are right at 32 bits, keep their top 16 at 24, and are 0 below") {
  const std::pair<std::uint32_t, const char*> cases[] = {{32, "a5c3962f"}, {24, "00a5c3"}, {16, "0000"}, {8, "00"}};
  for (const auto& [bits, expected] : cases) {
    DeviceConfiguration configuration = gateware_2012();
    configuration.data_bits = bits;
    DeviceBench bench(configuration);
    CHECK(bench.ask("#W:20" + std::string("a5c3962f").substr(0, bits / 4) + "\n") == "#S_W\n");
    CHECK(bench.ask("#R:20\n") == std::string("#S_R:") + expected + "\n");
  }
}

TEST_CASE("2012: the cycle of a bus timeout goes on") {
  SUBCASE("at address 0, where something answers") {
    DeviceBench bench(gateware_2012());
    CHECK(bench.ask("#R:F5\n#W:0500000007\n#R:05\n#R:00\n") == "#?E_BAT\n#S_W\n#S_R:00000007\n#S_R:40de0000\n");
    CHECK(bench.ask("#W:F500000007\n#R:05\n#R:00\n") == "#?E_BAT\n#S_R:00000007\n#S_R:00000000\n");
  }
  SUBCASE("else at the address of the next request, in its own direction") {
    DeviceBench bench(silent_at_0());
    CHECK(bench.ask("#R:F5\n#W:0500000007\n#R:05\n") == "#?E_BAT\n#S_W\n#S_R:40de0505\n");  // the write is lost
    CHECK(bench.ask("#W:F500000007\n#R:06\n#R:06\n").starts_with("#?E_BAT\n#S_R:"));
    CHECK(bench.ask("#R:06\n") == "#S_R:00000000\n");
    CHECK(bench.ask("#W:F500000007\n#R:00\n#R:F5\n#W:0700000007\n#R:07\n") ==
          "#?E_BAT\n#?E_BAT\n#?E_BAT\n#S_W\n#S_R:00000000\n");
  }
  SUBCASE("corrected gateware ends it") {
    DeviceConfiguration configuration = silent_at_0();
    configuration.published_2012 = false;
    DeviceBench bench(configuration);
    CHECK(bench.ask("#R:F5\n#W:0500000007\n#R:05\n") == "#?E_BAT\n#S_W\n#S_R:00000007\n");
    CHECK(bench.ask("#W:F500000007\n#R:06\n") == "#?E_BAT\n#S_R:40de0606\n");
  }
}

TEST_CASE("2012: a configuration with a 2C byte in it is understood, with its checksum") {
  for (const std::uint32_t base_hz : {44u, 256u, 300u, 556u, 11308u, 65536u}) {
    CAPTURE(base_hz);
    DeviceConfiguration configuration = gateware_2012();
    configuration.base_hz = base_hz;
    configuration.read_many = 44;
    const OldWire wire(configuration);
    CHECK(wire.engine->reported()->base_hz == base_hz);
    CHECK(wire.engine->reported()->read_many == 44);
  }
}

TEST_CASE("gateware without checksums is never sent a '$', where the URL says so") {
  DeviceConfiguration configuration = gateware_2012();
  configuration.checksum = device::Checksum::none;
  CHECK(DeviceBench(configuration).ask("$RLC*9B\n") == "?f4\n");
  OldWire wire(configuration, 64, false);
  CHECK_FALSE(wire.engine->checksums());
  Exchange silent = reading(0xF5);
  wire.run(silent);
  CHECK(silent.status == Status::bus_error);
  Exchange lost = reading(0x12);
  wire.device.receive_error(4);  // a fence follows
  wire.run(lost);
  CHECK(lost.value == 0x40de1212);
  CHECK(wire.sent.find('$') == std::string::npos);
  CHECK(wire.sent.starts_with("!#RLC\n"));
}

TEST_CASE("after a read that timed out a word that answers is read before anything else") {
  OldWire wire(silent_at_0());
  Exchange good = reading(0x12);
  wire.run(good);
  wire.sent.clear();
  Exchange silent = reading(0xF5);
  wire.run(silent);
  CHECK(wire.sent == "#R:F5\n#R:12\n");
  CHECK(silent.status == Status::bus_error);
  CHECK(told(silent).find("2012") == std::string::npos);  // the bus is free again
  Exchange write = writing(0x05, 7);
  wire.run(write);
  CHECK(write.status == Status::ok);
  CHECK(wire.memory(0x05) == 7);

  SUBCASE("a checked one where the request was") {
    Exchange checked = reading(0xF5, true);
    wire.sent.clear();
    wire.run(checked);
    CHECK(wire.sent == "$R:F5*E3\n$R:12*58\n");
  }
  SUBCASE("not one with a side effect") {
    Exchange fifo = reading(0x20, false, false);
    wire.run(fifo);
    wire.sent.clear();
    Exchange again = reading(0xF5);
    wire.run(again);
    CHECK(wire.sent == "#R:F5\n#R:12\n");
  }
  SUBCASE("not with gateware that is known to be corrected") {
    wire.engine->expect_corrected_gateware();
    wire.sent.clear();
    Exchange again = reading(0xF5);
    wire.run(again);
    CHECK(wire.sent == "#R:F5\n");
  }
}

TEST_CASE("a read that timed out with no word known to answer names the hazard, and no write behind it is believed") {
  OldWire wire(silent_at_0());
  Exchange silent = reading(0xF5);
  wire.run(silent);
  CHECK(wire.sent.ends_with("\n#R:F5\n"));
  CHECK(told(silent).find("2012 gateware loses the next write") != std::string::npos);
  Exchange write = writing(0x05, 7);
  wire.run(write);
  CHECK(write.status == Status::unknown);
  CHECK(told(write).find("after a bus timeout") != std::string::npos);
  Exchange silent_too = reading(0xF5);
  wire.run(silent_too);
  Exchange repeated = writing(0x05, 7, true);
  wire.run(repeated);
  CHECK(repeated.status == Status::ok);
  CHECK(wire.memory(0x05) == 7);
}

TEST_CASE("a write that timed out names what may come of it, and what was on its way behind it is not believed") {
  OldWire wire(silent_at_0());
  Exchange silent = writing(0xF5, 1);
  Exchange behind = reading(0x12);
  wire.submit(silent);
  wire.submit(behind);
  wire.run();
  CHECK(silent.status == Status::bus_error);
  CHECK(told(silent).find("written 0 to address 0") != std::string::npos);
  CHECK(told(silent).find("write 0 to the address that its next read or write names") != std::string::npos);
  CHECK(behind.status == Status::ok);
  CHECK(behind.value == wire.memory(0x12));  // 0, because the late write has changed it
  CHECK(behind.attempts == 2);

  Exchange again = writing(0xF5, 1);
  Exchange once = reading(0x13, false, false);
  wire.submit(again);
  wire.submit(once);
  wire.run();
  CHECK(once.status == Status::protocol_error);
  CHECK(told(once).find("after a bus timeout") != std::string::npos);
}

TEST_CASE("a cycle that is left over is remembered when the line is lost and comes back") {
  OldWire wire(silent_at_0());
  const auto lose_behind_a_timeout = [&wire] {
    Exchange silent = reading(0xF5);
    wire.submit(silent);
    const std::span<const std::uint8_t> bytes = wire.engine->transmit(wire.now());
    for (const std::uint8_t byte : bytes) {
      REQUIRE(wire.device.receive(byte));
    }
    wire.engine->sent(bytes.size());
    wire.device.run_until(wire.device.clock() + 5000);
    device::TimedByte byte;
    std::string answer;
    while (wire.device.take(byte)) {
      answer.push_back(static_cast<char>(byte.byte));
    }
    REQUIRE(answer == "#?E_BAT\n");
    wire.engine->receive(bytes_of(answer), wire.now());
    wire.engine->cut(Status::down, wire.now());
    REQUIRE(silent.done());
    wire.sent.clear();
    Exchange found;
    found.operation = Operation::resynchronise;
    wire.run(found);
    REQUIRE(found.status == Status::ok);
  };
  SUBCASE("and ended by a word that is known to answer") {
    Exchange good = reading(0x12);
    wire.run(good);
    lose_behind_a_timeout();
    Exchange write = writing(0x05, 7);
    wire.run(write);
    CHECK(wire.sent.find("#R:12\n") < wire.sent.find("#W:05"));
    CHECK(write.status == Status::ok);
    CHECK(wire.memory(0x05) == 7);
  }
  SUBCASE("else no write behind it is believed") {
    lose_behind_a_timeout();
    Exchange write = writing(0x05, 7);
    wire.run(write);
    CHECK(write.status == Status::unknown);
    CHECK(wire.memory(0x05) != 7);
    CHECK(told(write).find("after a bus timeout") != std::string::npos);
  }
}

TEST_CASE("no request that succeeds is wrong on 2012 gateware whose address 0 is silent") {
  std::uint32_t executed = 0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    OldWire wire(silent_at_0(), 16u << seed % 5);
    std::mt19937 random(seed);
    bool named = false;  // a write has timed out, and its error named the hazard
    for (unsigned round = 0; round < 40; ++round) {
      std::deque<Exchange> exchanges;
      std::array<bool, 256> used{};
      std::array<std::uint32_t, 256> before{};
      for (std::uint32_t address = 1; address < 0xE0; ++address) {
        before[address] = wire.memory(address);
      }
      for (auto count = 1 + random() % 6; count > 0; --count) {
        const auto address = static_cast<std::uint32_t>(random() % 4 == 0 ? 0xE8 + random() % 16 : 1 + random() % 0xD0);
        if (used[address]) {
          continue;
        }
        used[address] = true;
        const bool repeat = random() % 2 == 0;
        exchanges.push_back(random() % 2 == 0 ? reading(address, true, repeat)
                                              : writing(address, static_cast<std::uint32_t>(random()) | 1, repeat));
        exchanges.back().checked = true;
        wire.submit(exchanges.back());
      }
      wire.run();
      for (const Exchange& exchange : exchanges) {
        CAPTURE(seed);
        CAPTURE(round);
        CAPTURE(exchange.address);
        REQUIRE(exchange.done());
        const std::uint32_t now = wire.memory(exchange.address);
        if (exchange.status == Status::ok) {
          REQUIRE(now == exchange.value);
          ++executed;
        }
        named =
            named || (exchange.status == Status::bus_error && told(exchange).find("will write 0") != std::string::npos);
        if (!exchange.writes() && exchange.address < 0xE0 && !named) {
          REQUIRE(now == before[exchange.address]);
        }
      }
    }
  }
  CHECK(executed > 1000);
}

TEST_CASE("requests that overrun the device end with what it said, not with its silence") {
  for (unsigned variant = 0; variant < 16; ++variant) {
    CAPTURE(variant);
    DeviceConfiguration configuration = (variant & 1) != 0 ? gateware_2012() : device::test::bench();
    configuration.protocol = device::Protocol::classic;
    configuration.baud_hz = 3'000'000;
    configuration.fifo = 4;
    configuration.honour_flush = (variant & 2) != 0;
    OldWire wire(configuration, 256);
    std::deque<Exchange> exchanges;
    for (std::uint32_t address = 0; address < 60; ++address) {
      exchanges.push_back(reading(address, (variant & 4) != 0));
      exchanges.back().attempts_max = (variant & 8) != 0 ? 3 : 1;
      wire.submit(exchanges.back());
    }
    wire.run();
    std::uint32_t failed = 0;
    for (const Exchange& exchange : exchanges) {
      REQUIRE(exchange.done());
      CAPTURE(told(exchange));
      if (exchange.status == Status::ok) {
        CHECK(exchange.value == wire.memory(exchange.address));
        continue;
      }
      ++failed;
      CHECK(exchange.status == Status::protocol_error);
      // With one attempt, the error may name the damage and not its cause, because 2012 gateware may report the damage
      // first.
      const bool one_of_both = exchange.attempts_max == 1 && configuration.published_2012;
      CHECK((told(exchange).find("it said ?f9 (more requests came than its receive FIFO holds") != std::string::npos ||
             (one_of_both && told(exchange).find("it said ?f") != std::string::npos)));
    }
    CHECK(failed > 0);  // the credit was too large for the device, so it answers ?f9
  }
}
