// SPDX-License-Identifier: BSD-3-Clause
// Each call on a link ends within its attempts, on the link's own clock, whatever the device answers, or if it does
// not.
#include <doctest/doctest.h>

#include <array>
#include <functional>
#include <memory>
#include <vector>

#include "layer2_message/link.hpp"
#include "times.hpp"
#include "virtual_line.hpp"

using namespace unitylink;
using unitylink::test::ms;
using unitylink::test::VirtualLine;
using unitylink::test::VirtualPlace;

namespace {

constexpr std::uint64_t attempts_ns = 3 * 20 * ms;
constexpr std::uint64_t slack_ns = 10 * ms;  // for the bytes of one request, and the steps of the clock

LinkOptions options() {
  LinkOptions options;
  options.engine.timeout_ns = 20 * ms;
  options.engine.seed = 7;
  options.protocol = Protocol::framed;
  return options;
}

constexpr std::array lies{faults::Peer::dead,     faults::Peer::half_dead, faults::Peer::closing,
                          faults::Peer::renewing, faults::Peer::refusing,  faults::Peer::waiting};

}  // namespace

TEST_CASE("a link that cannot begin ends its attempt in time, and its seldom successes are links") {
  for (const faults::Peer peer : lies) {
    for (const Protocol protocol : {Protocol::automatic, Protocol::classic, Protocol::framed}) {
      CAPTURE(static_cast<int>(peer));
      CAPTURE(static_cast<int>(protocol));
      VirtualPlace place;
      place.liar.set(peer);
      LinkOptions asked = options();
      asked.protocol = protocol;
      std::unique_ptr<Link> link;
      const std::uint64_t begun_ns = VirtualPlace::clock_ns;
      const Outcome outcome = Link::open(std::make_unique<VirtualLine>(place), asked, link);
      // closing a session may take 200 ms more
      CHECK(VirtualPlace::clock_ns - begun_ns <= 4 * attempts_ns + 200 * ms + slack_ns);
      CHECK(!outcome.ok());
      CHECK(!outcome.text.empty());
    }
  }
}

TEST_CASE("no call waits for more than its attempts, however the device goes on") {
  using Call = std::function<Outcome(Link&)>;
  const std::vector<std::uint32_t> many(100, 0x11);
  const std::vector<Call> calls{
      [](Link& link) {
        std::uint32_t value = 0;
        return link.read(0x10, value, {});
      },
      [](Link& link) { return link.write(0x10, 1, {}); },
      [&](Link& link) { return link.write_many(many, many, {}); },
      [&](Link& link) {
        std::vector<std::uint32_t> values(100);
        return link.read_each(many, values, {});
      },
      [](Link& link) {
        std::array<std::uint32_t, 4> values{};
        return link.read_control(0, values, {});
      },
      [](Link& link) { return link.sync({}); },
      [&](Link& link) {
        const Outcome posted = link.post(many, many, {});
        return posted.ok() ? link.sync({}) : posted;
      },
  };
  for (const faults::Peer peer : lies) {
    CAPTURE(static_cast<int>(peer));
    VirtualPlace place;
    std::unique_ptr<Link> link;
    REQUIRE(Link::open(std::make_unique<VirtualLine>(place), options(), link).ok());
    std::uint32_t value = 0;
    REQUIRE(link->read(0x10, value, {}).ok());
    place.liar.set(peer);
    for (int round = 0; round < 2; ++round) {  // the second round begins with what the first has left in the link
      for (std::size_t call = 0; call < calls.size(); ++call) {
        CAPTURE(call);
        const std::uint64_t begun_ns = VirtualPlace::clock_ns;
        const Outcome outcome = calls[call](*link);
        CHECK(VirtualPlace::clock_ns - begun_ns <= attempts_ns + slack_ns);
        CHECK(!outcome.ok());
      }
    }
    place.liar.set(faults::Peer::honest);
    for (int round = 0; round < 10 && !link->read(0x10, value, {}).ok(); ++round) {}
    const Outcome after = link->read(0x10, value, {});
    CAPTURE(after.text);
    CHECK(after.ok());
    CHECK(link->write(0x10, 3, {}).ok());
  }
}

TEST_CASE("a device that tells no more lies is served again within four timeouts, whenever it begins to be honest") {
  for (const faults::Peer peer : lies) {
    CAPTURE(static_cast<int>(peer));
    std::uint64_t longest_ns = 0;
    for (std::uint64_t seed = 1; seed <= 40; ++seed) {
      CAPTURE(seed);
      VirtualPlace place(seed);
      LinkOptions asked = options();
      asked.attempts = 100;
      std::unique_ptr<Link> link;
      REQUIRE(Link::open(std::make_unique<VirtualLine>(place), asked, link).ok());
      place.liar.set(peer);
      std::uint32_t value = 0;
      for (std::uint64_t call = 0; call < 1 + seed % 4; ++call) {
        const std::uint64_t until_ns = VirtualPlace::clock_ns + 1 * ms + place.random() % (150 * ms);
        CHECK(!(call % 2 == 0 ? link->read(0x10, value, {.until_ns = until_ns})
                              : link->write(0x10, 1, {.until_ns = until_ns}))
                   .ok());
      }
      place.liar.set(faults::Peer::honest);
      const std::uint64_t honest_ns = VirtualPlace::clock_ns;
      REQUIRE(link->read(0x10, value, {}).ok());
      REQUIRE(link->write(0x10, 2, {}).ok());
      longest_ns = std::max(longest_ns, VirtualPlace::clock_ns - honest_ns);
    }
    CHECK(longest_ns <= 4 * 20 * ms + slack_ns);
  }
}

TEST_CASE("a device that sends the engine back to the beginning is not asked at the rate of the line") {
  for (const faults::Peer peer : lies) {
    CAPTURE(static_cast<int>(peer));
    VirtualPlace place;
    std::unique_ptr<Link> link;
    LinkOptions asked = options();
    asked.attempts = 100;
    REQUIRE(Link::open(std::make_unique<VirtualLine>(place), asked, link).ok());
    place.liar.set(peer);
    const std::uint64_t sent = link->statistics().bytes_sent;
    const std::uint64_t begun_ns = VirtualPlace::clock_ns;
    const std::uint64_t until_ns = begun_ns + 2000 * ms;
    std::uint32_t value = 0;
    std::uint64_t calls = 0;
    // a refused call ends at once, and this loop makes the next one without a pause
    for (; VirtualPlace::clock_ns < until_ns; ++calls) {
      static_cast<void>(link->read(0x10, value, {.until_ns = until_ns}));
    }
    const std::uint64_t bytes = link->statistics().bytes_sent - sent;
    // 100 pauses as long as a timeout, and the shorter ones before. After each: HELLO or OPEN, and what is in flight,
    // 40 bytes.
    CHECK(bytes <= (100 + 12) * 40 + calls * 200);
  }
}

TEST_CASE("a device for which it is never a request's turn is not asked at the rate of the line") {
  VirtualPlace place;
  std::unique_ptr<Link> link;
  LinkOptions asked = options();
  asked.attempts = 100;
  REQUIRE(Link::open(std::make_unique<VirtualLine>(place), asked, link).ok());
  // Chained requests: only the device knows which one is next.
  const std::vector<std::uint32_t> words(200, 0x11);
  place.liar.set(faults::Peer::waiting);
  const std::uint64_t before = place.turns;
  CHECK(!link->write_many(words, words, {.until_ns = VirtualPlace::clock_ns + 2000 * ms}).ok());
  // In each timeout one repeat and one HELLO; at the beginning also 16 repeats at once.
  CHECK(place.turns - before <= 2 * 100 + 2 * 16);
}

TEST_CASE("a device with frames is never taken for a classic one, however much its line loses") {
  for (const double share : {0.01, 0.10}) {
    int linked = 0;
    for (std::uint64_t seed = 1; seed <= 400; ++seed) {
      VirtualPlace place(seed);
      place.lose(share);
      LinkOptions asked = options();
      asked.protocol = Protocol::automatic;
      asked.engine.seed = seed;
      std::unique_ptr<Link> link;
      const Outcome outcome = Link::open(std::make_unique<VirtualLine>(place), asked, link);
      CAPTURE(seed);
      CAPTURE(outcome.text);
      const bool framed = !outcome.ok() || link->framed();
      CHECK(framed);
      linked += outcome.ok() ? 1 : 0;
    }
    CHECK(linked > (share < 0.05 ? 396 : 300));
  }
}

TEST_CASE("what it costs to find out that a device is a classic one") {
  device::DeviceConfiguration configuration;
  std::array<std::uint64_t, 2> turns{};
  std::array<std::uint64_t, 2> bytes{};
  for (const bool framed : {false, true}) {
    configuration.protocol = framed ? device::Protocol::both : device::Protocol::classic;
    VirtualPlace place(1, configuration);
    LinkOptions asked = options();
    asked.protocol = Protocol::automatic;
    std::unique_ptr<Link> link;
    REQUIRE(Link::open(std::make_unique<VirtualLine>(place), asked, link).ok());
    CHECK(link->framed() == framed);
    turns[framed] = place.turns;
    bytes[framed] = link->statistics().bytes_sent;
  }
  // The fence, and each HELLO with a classic question. Its answer has 32 bytes, more than a FIFO of 16, so they go one
  // by one.
  CHECK(turns[0] == 1 + 8);
  CHECK(turns[1] <= 5);
  CHECK(bytes[0] < 150);  // 13 ms at 115,200 baud
}

TEST_CASE("a classic device is found out on a bad line, too") {
  device::DeviceConfiguration configuration;
  configuration.protocol = device::Protocol::classic;
  int linked = 0;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    VirtualPlace place(seed, configuration);
    place.lose(0.05);
    LinkOptions asked = options();
    asked.protocol = Protocol::automatic;
    asked.engine.timeout_ns = 100 * ms;
    std::unique_ptr<Link> link;
    const Outcome outcome = Link::open(std::make_unique<VirtualLine>(place), asked, link);
    CAPTURE(seed);
    CAPTURE(outcome.text);
    linked += outcome.ok() ? 1 : 0;
    CHECK((!outcome.ok() || !link->framed()));
  }
  CHECK(linked > 90);
}

TEST_CASE("publishes that an old program has left do not hide the frames of a device") {
  VirtualPlace place;
  std::string greeting;
  LinkOptions asked = options();
  asked.protocol = Protocol::automatic;
  std::unique_ptr<Link> link;
  // Before the link opens, the device already publishes one word a thousand times a second, in the classic protocol.
  for (const char letter : std::string("#WSA:000100\n#WSR:000001\n#EPS\n")) {
    static_cast<void>(place.device.receive(static_cast<std::uint8_t>(letter)));
    place.device.run_until(place.device.clock() + 20'000);
  }
  REQUIRE(Link::open(std::make_unique<VirtualLine>(place), asked, link).ok());
  CHECK(link->framed());
}
