// SPDX-License-Identifier: BSD-3-Clause
// Which thread reads publishes: the one that waits for them, else the reader. When they change, nobody may wait for
// ever.
#include <doctest/doctest.h>

#include <array>
#include <atomic>
#include <string>
#include <thread>
#include <vector>

#include "device/board.hpp"
#include "device/endpoints.hpp"
#include "layer0_driver/descriptor_driver.hpp"
#include "layer2_message/link.hpp"

using namespace unitylink;

namespace {

constexpr std::uint64_t patience_ns = 10'000'000'000;

// Remembers which thread has read last.
struct WatchedDriver final : DescriptorDriver {
  explicit WatchedDriver(int descriptor, std::atomic<std::thread::id>& reader)
      : DescriptorDriver(descriptor), reader_(reader) {}
  Transfer receive(std::span<std::uint8_t> room) noexcept override {
    reader_ = std::this_thread::get_id();
    return DescriptorDriver::receive(room);
  }
  std::atomic<std::thread::id>& reader_;
};

struct Fixture {
  explicit Fixture(bool framed) {
    device::DeviceConfiguration configuration;
    configuration.groups = 4;
    configuration.protocol = framed ? device::Protocol::both : device::Protocol::classic;
    board = std::make_unique<device::Board>(configuration, device::make_endpoint("fd", "127.0.0.1"));
    board->start();
    const int descriptor = std::stoi(board->url().substr(3));
    REQUIRE(Link::open(std::make_unique<WatchedDriver>(descriptor, reader), LinkOptions{}, link).ok());
  }
  std::uint32_t subscribed(std::uint32_t address, std::uint32_t divisor) {
    std::uint32_t id = 0;
    const std::array<std::uint32_t, 1> addresses{address};
    REQUIRE(link->subscribe({.addresses = addresses, .divisor = divisor, .ring = 100'000}, id).ok());
    return id;
  }
  std::size_t drained(std::uint32_t id) const {
    std::array<double, 256> times{};
    std::array<std::uint32_t, 256> words{};
    return link->drain(id, times, words);
  }
  std::unique_ptr<device::Board> board;
  std::atomic<std::thread::id> reader;
  std::unique_ptr<Link> link;
};

TEST_CASE("who waits for publishes reads again when the thread that attended the link leaves it") {
  Fixture at(true);
  const std::uint32_t id = at.subscribed(1, 20);
  std::atomic<bool> over = false;
  std::atomic<bool> forgotten = false;
  std::atomic<unsigned> came = 0;
  std::thread listener([&] {
    while (!over && !forgotten) {
      forgotten = !at.link->wait_publish(id, patience_ns);
      while (at.drained(id) > 0) {}
      ++came;
    }
  });
  for (int round = 0; round < 5; ++round) {
    for (const std::uint64_t until = at.link->now_ns() + 10'000'000; at.link->now_ns() < until;) {
      at.link->attend(-1, until, false);
    }
    at.link->leave();
    for (const unsigned before = came; came < before + 2 && !forgotten;) {
      std::this_thread::yield();
    }
  }
  over = true;
  listener.join();
  CHECK_FALSE(forgotten);
}

TEST_CASE("who waits for publishes reads them, and the reader when nobody does") {
  for (const bool framed : {false, true}) {
    CAPTURE(framed);
    Fixture at(framed);
    const std::uint32_t id = at.subscribed(1, 1);
    const std::uint64_t until = real_ns() + patience_ns;
    for (bool own = false; !own;) {
      REQUIRE(real_ns() < until);
      REQUIRE(at.link->wait_publish(id, patience_ns));
      own = at.reader.load() == std::this_thread::get_id();
      while (at.drained(id) > 0) {}
    }
    for (const std::size_t before = at.link->available(id); at.link->available(id) < before + 3;) {
      REQUIRE(real_ns() < until);
      std::this_thread::yield();
    }
    CHECK(at.reader.load() != std::this_thread::get_id());
    CHECK(at.link->unsubscribe(id).ok());
  }
}

TEST_CASE("listeners, callers and the reader take turns, and none is forgotten") {
  for (const bool framed : {false, true}) {
    CAPTURE(framed);
    Fixture at(framed);
    const std::array<std::uint32_t, 3> ids{at.subscribed(1, 1), at.subscribed(2, 3), at.subscribed(3, 10)};
    std::array<std::atomic<std::size_t>, 3> counted{};
    std::atomic<std::size_t> all = 0;
    std::atomic<unsigned> failed = 0;
    std::vector<std::thread> threads;
    for (std::size_t index = 0; index < ids.size(); ++index) {
      threads.emplace_back([&, index] {
        while (counted[index] < 30) {
          failed += at.link->wait_publish(ids[index], patience_ns) ? 0 : 1;
          counted[index] += at.drained(ids[index]);
        }
      });
    }
    threads.emplace_back([&] {
      for (std::uint64_t seen = 0; seen < 100; ++all) {
        const std::uint64_t now = at.link->wait_publishes(seen, patience_ns);
        failed += now == seen ? 1 : 0;
        seen = now;
      }
    });
    threads.emplace_back([&] {
      std::uint32_t value = 0;
      for (std::uint32_t turn = 0; turn < 500; ++turn) {
        failed += at.link->write(0x21, turn, {}).ok() && at.link->read(0x21, value, {}).ok() && value == turn ? 0 : 1;
      }
    });
    for (std::thread& thread : threads) {
      thread.join();
    }
    CHECK(failed == 0);
    CHECK(all > 0);
  }
}

TEST_CASE("who waits for publishes hears of the end: of the subscription, of the link") {
  Fixture at(false);
  const std::uint32_t id = at.subscribed(1, 0xFFFF);
  const std::uint32_t other = at.subscribed(2, 0xFFFF);
  std::atomic<unsigned> waiting = 0;
  bool come = true;
  std::thread first([&] {
    ++waiting;
    while ((come = at.link->wait_publish(id, 3'600'000'000'000)) && at.link->subscribed(id)) {
      at.drained(id);
    }
  });
  std::thread second([&] {
    ++waiting;
    while (at.link->wait_publish(other, ~std::uint64_t{0})) {
      at.drained(other);
    }
  });
  while (waiting < 2) {
    std::this_thread::yield();
  }
  CHECK(at.link->unsubscribe(id).ok());
  first.join();
  CHECK_FALSE(come);
  CHECK_FALSE(at.link->wait_publish(id, 3'600'000'000'000));
  at.link->close();
  second.join();
  CHECK_FALSE(at.link->wait_publish(other, 3'600'000'000'000));
}

}  // namespace

TEST_CASE("what the device had sent when a subscription ends can be drained, and who waits is told") {
  for (const bool framed : {false, true}) {
    CAPTURE(framed);
    Fixture at(framed);
    std::uint64_t drained = 0;
    for (std::uint32_t round = 0; round < 20; ++round) {
      const std::array<std::uint32_t, 2> ids{at.subscribed(1, 1), at.subscribed(2, 2)};
      REQUIRE(at.link->wait_publish(ids[round % 2], patience_ns));
      const std::uint64_t seen = at.link->statistics().publishes + 2 * round;
      for (const std::uint32_t id : ids) {
        CHECK(at.link->unsubscribe(id).ok());
        CHECK_FALSE(at.link->subscribed(id));
        drained += at.drained(id);
      }
      CHECK(at.link->statistics().publishes == drained);
      CHECK(at.link->wait_publishes(seen, patience_ns) >= seen + 2);
    }
    CHECK((framed || at.link->statistics().unclaimed_publishes == 0));
  }
}
