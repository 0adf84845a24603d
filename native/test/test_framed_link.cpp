// SPDX-License-Identifier: BSD-3-Clause
// Link and FramedEngine with the twin: reads, writes, transfers, posts, publishes, and the errors of refused requests.
#include <doctest/doctest.h>

#include <memory>
#include <numeric>
#include <string>
#include <vector>

#include "device/board.hpp"
#include "device/endpoints.hpp"
#include "layer2_message/link.hpp"

using namespace unitylink;

extern "C" int abi_test(const char* url);

namespace {

struct Desk {
  explicit Desk(const std::string& options = "", device::DeviceConfiguration configuration = {})
      : board(configuration, device::make_endpoint("fd", "127.0.0.1")) {
    board.start();
    const std::string url =
        board.url() + (board.url().find('?') == std::string::npos ? "?" : "&") + "timeout=2&" + options;
    outcome = Link::open(url.substr(0, url.find_last_not_of('&') + 1), link);
  }
  device::Board board;
  std::unique_ptr<Link> link;
  Outcome outcome;
};

std::vector<std::uint32_t> counting(std::size_t count, std::uint32_t from) {
  std::vector<std::uint32_t> words(count);
  std::iota(words.begin(), words.end(), from);
  return words;
}

}  // namespace

TEST_CASE("a link finds out that the device speaks frames") {
  for (const char* options : {"", "protocol=auto", "protocol=framed"}) {
    const Desk desk(options);
    CAPTURE(desk.outcome.text);
    REQUIRE(desk.outcome.ok());
    CHECK(desk.link->framed());
    CHECK(desk.link->notice().empty());
    CHECK(desk.link->description().clock_hz == 50'000'000);
    CHECK(desk.link->statistics().sessions == 1);
  }
  const Desk classic("protocol=classic");
  CHECK(!classic.link->framed());
  CHECK(classic.link->notice().empty());
  device::DeviceConfiguration old;
  old.protocol = device::Protocol::classic;
  const Desk fallen("", old);
  CHECK(!fallen.link->framed());
  CHECK(!fallen.link->notice().empty());
  const Desk refused("protocol=framed&attempts=1", old);
  CHECK(refused.outcome.status == Status::timeout);
  CHECK(Desk("data_bytes=2").outcome.status == Status::mismatch);
}

TEST_CASE("words over frames, one message each way where they fit") {
  const Desk desk;
  REQUIRE(desk.outcome.ok());
  Link& link = *desk.link;
  const std::vector<std::uint32_t> addresses = counting(200, 0x10);
  const std::vector<std::uint32_t> words = counting(200, 1000);
  REQUIRE(link.write_many(addresses, words, {}).ok());
  std::vector<std::uint32_t> values(200);
  REQUIRE(link.read_many(addresses, values, false, {}).ok());
  CHECK(values == words);
  REQUIRE(link.read_each(addresses, values, {}).ok());
  CHECK(values == words);
  const std::uint64_t before = link.statistics().requests;
  const std::vector<std::uint32_t> scattered{0x10, 0x13, 0x21, 0x18, 0x40, 0x41, 0x60, 0x33, 0x35};
  std::vector<std::uint32_t> read(scattered.size());
  REQUIRE(link.transfer(scattered, counting(scattered.size(), 1), scattered, read, true, {}).ok());
  CHECK(read == counting(scattered.size(), 1));
  CHECK(link.statistics().requests == before + 1);
  const Outcome outside =
      link.transfer(std::vector<std::uint32_t>{0x100}, std::vector<std::uint32_t>{1}, {}, {}, false, {});
  CHECK(outside.status == Status::range);
  CHECK(outside.address == 0x100);
}

TEST_CASE("posts arrive in order, before what follows them, and sync tells those that failed") {
  device::DeviceConfiguration configuration;
  configuration.silent_ranges = {{0x77, 0x77}};
  const Desk desk("", configuration);
  CAPTURE(desk.outcome.text);
  REQUIRE(desk.outcome.ok());
  Link& link = *desk.link;
  const std::vector<std::uint32_t> one(20'000, 0x20);
  REQUIRE(link.post(one, counting(one.size(), 1), {}).ok());
  std::uint32_t value = 0;
  REQUIRE(link.read(0x20, value, {}).ok());
  CHECK(value == 20'000);
  CHECK(link.sync({}).ok());
  CHECK(link.statistics().posts == 20'000);
  for (const std::uint32_t address : {0x20u, 0x77u, 0x21u}) {
    REQUIRE(link.post(std::vector<std::uint32_t>{address}, std::vector<std::uint32_t>{address}, {}).ok());
  }
  const Outcome failed = link.sync({});
  CHECK(failed.status == Status::bus_error);
  CHECK(failed.address == 0x77);
  CHECK(link.sync({}).ok());
  CHECK(link.read(0x21, value, {}).ok());
  CHECK(value == 0x21);
  const Desk other("", configuration);
  REQUIRE(other.outcome.ok());
  // one message
  REQUIRE(other.link->post(std::vector<std::uint32_t>{0x20, 0x77, 0x21}, std::vector<std::uint32_t>{1, 2, 3}, {}).ok());
  const Outcome list = other.link->sync({});
  CHECK(list.status == Status::bus_error);
  CAPTURE(list.text);
  CHECK(list.text.find("one of 3 words from 0x") != std::string::npos);
  CHECK(other.link->read(0x21, value, {}).ok());
  CHECK(value == 0);
  CHECK(link.read(0x77, value, {}).status == Status::bus_error);
}

TEST_CASE("publishes have the device's times, and none is missing") {
  device::DeviceConfiguration configuration;
  configuration.groups = 4;
  const Desk desk("", configuration);
  REQUIRE(desk.outcome.ok());
  Link& link = *desk.link;
  REQUIRE(link.write(0x20, 7, {}).ok());
  std::uint32_t id = 0;
  const std::vector<std::uint32_t> addresses{0x20, 0x21};
  REQUIRE(link.subscribe({.addresses = addresses, .divisor = 1}, id).ok());
  std::vector<double> times(100);
  std::vector<std::uint32_t> values(200);
  std::size_t had = 0;
  while (had < 50) {
    REQUIRE(link.wait_publish(id, 10'000'000'000));
    const std::size_t count = link.drain(id, times, values);
    for (std::size_t index = 0; index < count; ++index) {
      CHECK(values[2 * index] == 7);
    }
    had += count;
  }
  CHECK(link.missing(id) == 0);
  CHECK(link.clock().period_ns > 0);
  CHECK(link.unsubscribe(id).ok());
  CHECK(link.drain(id, times, values) <= 100);
}

TEST_CASE("the device's own registers, and a spec that is not the gateware's") {
  device::DeviceConfiguration configuration;
  configuration.spec_hash = 0x1234;
  const Desk desk("spec_hash=1234", configuration);
  REQUIRE(desk.outcome.ok());
  std::vector<std::uint32_t> value(1);
  REQUIRE(desk.link->read_control(protocol::control::spec_hash_low, value, {}).ok());
  CHECK(value[0] == 0x1234);
  CHECK(desk.link->read_control(0x7000, value, {}).status == Status::protocol_error);
  CHECK(desk.link->write_control(protocol::control::clock_hz, 1, {}).status == Status::protocol_error);
  const Desk other("spec_hash=1235", configuration);
  CHECK(other.outcome.status == Status::mismatch);
  CHECK(other.outcome.text.find("0000000000001235") != std::string::npos);
}

TEST_CASE("whose gateware answers is known, not known, or overridden") {
  device::DeviceConfiguration configuration;
  configuration.spec_hash = 0x1234;
  const std::uint64_t whole_or_part[] = {0x1235, 0x1234}, others[] = {0x1235};
  std::string unverified = "?";
  const Desk desk("", configuration);
  CHECK(desk.link->check_spec("arm.ul", whole_or_part, unverified).ok());
  CHECK(unverified.empty());
  const Outcome refused = desk.link->check_spec("arm.ul", others, unverified);
  CHECK(refused.status == Status::mismatch);
  CHECK(refused.text.find("another spec than arm.ul: its wire hash is 0000000000001234, and 0000000000001235") !=
        std::string::npos);
  const Desk any("spec_hash=any", configuration);
  CHECK(any.link->check_spec("arm.ul", others, unverified).ok());
  CHECK(unverified.find("spec_hash=any goes on") != std::string::npos);
  CHECK(any.link->check_spec("arm.ul", whole_or_part, unverified).ok());
  CHECK(unverified.empty());
  const Desk nameless("", device::DeviceConfiguration{});
  CHECK(nameless.link->check_spec("arm.ul", others, unverified).ok());
  CHECK(unverified.find("without the hash of its spec") != std::string::npos);
  CHECK(Desk("spec_hash=1234").outcome.status == Status::mismatch);
  const Desk classic("protocol=classic", configuration);
  CHECK(classic.link->check_spec("arm.ul", others, unverified).ok());
  CHECK(unverified.find("classic gateware cannot report") != std::string::npos);
  CHECK(Desk("protocol=classic&spec_hash=1234", configuration).outcome.status == Status::mismatch);
}

TEST_CASE("the C ABI over frames, from C") {
  device::Board board(device::DeviceConfiguration{}, device::make_endpoint("fd", "127.0.0.1"));
  board.start();
  CHECK(abi_test(board.url().c_str()) == 0);
}
