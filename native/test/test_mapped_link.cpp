// SPDX-License-Identifier: BSD-3-Clause
// Mapped memory: MappedEngine on a virtual clock; the link and the C ABI on a file that is mapped.
#include <doctest/doctest.h>

#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <thread>
#include <unistd.h>
#include <vector>

#include "layer0_driver/mapped_memory.hpp"
#include "layer2_message/link.hpp"
#include "layer2_message/mapped_engine.hpp"

using namespace unitylink;

extern "C" int abi_test(const char* url);

namespace {

constexpr std::uint64_t ms_of_polls = 1'000'000;

// A file of 256 words, which the test and the link share.
struct Registers {
  Registers() {
    const int file = ::mkstemp(path.data());
    REQUIRE(file >= 0);
    REQUIRE(::ftruncate(file, 4 * 256) == 0);
    ::close(file);
    REQUIRE(MappedMemory::open({path, 0, 4 * 256, 1, 1000}, memory).ok());
  }
  ~Registers() { ::unlink(path.c_str()); }

  std::unique_ptr<Link> link(const std::string& options = "") const {
    std::unique_ptr<Link> opened;
    const Outcome outcome = Link::open("mmap:" + path + options, opened);
    CAPTURE(outcome.text);
    REQUIRE(outcome.ok());
    return opened;
  }

  std::string path = "/tmp/unitylink-mapped-XXXXXX";
  std::unique_ptr<MappedMemory> memory;
};

// An engine with one group of two words, polled every 10 ms from time 0 on.
struct Polls {
  Polls() {
    Configuration configuration;
    configuration.base_hz = 1000;
    engine.configure(configuration);
    Exchange exchange;
    exchange.operation = Operation::define_group;
    exchange.address = 7;
    exchange.addresses = addresses;
    exchange.value = 10;
    exchange.ring = &ring;
    engine.submit(exchange, 0);
    CHECK(exchange.status == Status::ok);
  }

  Registers registers;
  std::array<std::uint32_t, 2> addresses{3, 4};
  MappedEngine engine{*registers.memory};
  PublishRing ring{2, 4};
};

}  // namespace

TEST_CASE("mapped memory: a group is polled when it is due, and a late poll is lost") {
  Polls polls;
  polls.registers.memory->store(3, 33);
  polls.registers.memory->store(4, 44);
  CHECK(polls.engine.next_deadline_ns() == 10 * ms_of_polls);
  polls.engine.advance(9 * ms_of_polls);
  CHECK(polls.ring.size() == 0);
  polls.engine.advance(10 * ms_of_polls);
  polls.engine.advance(10 * ms_of_polls);
  CHECK(polls.ring.size() == 1);
  CHECK(polls.engine.next_deadline_ns() == 20 * ms_of_polls);
  polls.engine.advance(47 * ms_of_polls);  // the polls due at 30 and 40 ms are lost
  CHECK(polls.ring.size() == 2);
  CHECK(polls.ring.lost() == 2);
  CHECK(polls.engine.next_deadline_ns() == 50 * ms_of_polls);

  std::array<double, 4> times{};
  std::array<std::uint32_t, 8> values{};
  CHECK(polls.ring.drain(times, values) == 2);
  CHECK(values[0] == 33);
  CHECK(values[3] == 44);
  CHECK(times[0] == doctest::Approx(0.010));
  CHECK(times[1] == doctest::Approx(0.047));
  CHECK(polls.engine.statistics().publishes == 2);

  for (std::uint64_t due = 5; due < 11; ++due) {  // a ring of 4 keeps the newest
    polls.engine.advance(10 * due * ms_of_polls);
  }
  CHECK(polls.ring.lost() == 4);
  CHECK(polls.engine.statistics().overruns == 2);
  polls.engine.claim(7, nullptr);
  CHECK(polls.engine.next_deadline_ns() == Engine::no_deadline);
}

TEST_CASE("mapped memory: nothing is polled nor accessed after the end") {
  Polls polls;
  polls.engine.end(Status::closed, 1);
  CHECK(polls.engine.next_deadline_ns() == Engine::no_deadline);
  polls.engine.advance(100 * ms_of_polls);
  CHECK(polls.ring.size() == 0);
  std::uint32_t value = 0;
  CHECK(!polls.engine.read(1, value));
  CHECK(!polls.engine.write(1, value));
  Exchange exchange;
  polls.engine.submit(exchange, 2);
  CHECK(exchange.done());
  CHECK(exchange.status == Status::closed);
}

TEST_CASE("mapped memory: the C ABI does all that it does on a link") {
  const Registers registers;
  CHECK(abi_test(("mmap:" + registers.path).c_str()) == 0);
}

TEST_CASE("mapped memory: requests, and what is refused") {
  const Registers registers;
  const auto link = registers.link();
  CHECK(std::string(link->protocol()) == "memory");
  CHECK(link->configuration().address_bytes == 1);
  const std::vector<std::uint32_t> addresses{1, 2, 0x100, 3};
  const Outcome outcome = link->write_many(addresses, std::vector<std::uint32_t>{10, 20, 30, 40}, {});
  CHECK(outcome.status == Status::bus_error);
  CHECK(outcome.index == 2);
  CHECK(outcome.address == 0x100);
  CHECK(outcome.text.find("beyond the mapped memory, which has words 0 to 0x00FF") != std::string::npos);
  CHECK(registers.memory->load(2) == 20);
  CHECK(registers.memory->load(3) == 0);  // not written, because the write before it failed

  std::vector<std::uint32_t> values(300);  // more words than any message of a protocol has
  std::vector<std::uint32_t> twos(300, 2);
  CHECK(link->read_many(twos, values, true, {.repeat = true}).ok());
  CHECK(values[299] == 20);
  CHECK(link->read_many(twos, values, true, {}).status == Status::mismatch);
  std::uint32_t group = 0;
  REQUIRE(link->define_exchange(std::vector<ExchangeWord>{{5, 4}}, std::vector<ExchangeWord>{{5, 1}}, group).ok());
  CHECK(link->exchange(group, std::vector<std::uint32_t>{0x1234}, values, {}).ok());
  CHECK(values[0] == 0x34);
  CHECK(link->set_dead_man(1, {}).status == Status::mismatch);
  CHECK(link->watch_program(1).status == Status::mismatch);
  CHECK(link->read_control(0, values, {}).text.find("mapped memory has no protocol") != std::string::npos);
  link->close();
  CHECK(link->read(1, values[0], {}).status == Status::closed);
}

TEST_CASE("mapped memory: who calls all the time does not keep the groups from being polled") {
  const Registers registers;
  const auto link = registers.link("?base_hz=10000");
  const std::vector<std::uint32_t> addresses{9};
  std::uint32_t slow = 0;
  std::uint32_t fast = 0;
  REQUIRE(link->subscribe({.addresses = addresses, .divisor = 0xFFFFFFFF}, slow).ok());
  // the reader may sleep until `slow` is due
  REQUIRE(link->subscribe({.addresses = addresses, .divisor = 10}, fast).ok());
  std::vector<std::uint32_t> values(1);
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (link->available(fast) < 5 && std::chrono::steady_clock::now() < limit) {
    CHECK(link->read_each(addresses, values, {.repeat = true}).ok());
  }
  CHECK(link->available(fast) >= 5);
  CHECK(link->available(slow) == 0);
  CHECK(link->unsubscribe(fast).ok());
  CHECK(!link->wait_publish(slow, 1));
}

TEST_CASE("mapped memory: a group is polled in its time although the one before is due in a day") {
  const Registers registers;
  const auto link = registers.link("?base_hz=10000");
  const std::vector<std::uint32_t> addresses{9};
  std::uint32_t slow = 0;
  std::uint32_t fast = 0;
  REQUIRE(link->subscribe({.addresses = addresses, .divisor = 0xFFFFFFFF}, slow).ok());
  std::this_thread::sleep_for(std::chrono::milliseconds(20));  // the reader sleeps until `slow` is due
  REQUIRE(link->subscribe({.addresses = addresses, .divisor = 10}, fast).ok());
  const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (link->available(fast) < 5 && std::chrono::steady_clock::now() < limit) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(link->available(fast) >= 5);
}
