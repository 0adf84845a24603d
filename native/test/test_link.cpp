// SPDX-License-Identifier: BSD-3-Clause
// Link on real descriptors: with the twin on every kind of endpoint, and when a port disappears.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <fcntl.h>
#include <poll.h>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "device/board.hpp"
#include "device/endpoints.hpp"
#include "layer0_driver/descriptor_driver.hpp"
#include "layer2_message/link.hpp"

using namespace unitylink;

extern "C" int abi_test(const char* url);

namespace {

device::DeviceConfiguration plain_board() {
  device::DeviceConfiguration configuration;
  configuration.groups = 4;
  configuration.group_size = 16;
  configuration.read_many = 32;
  return configuration;
}

// A board with the classic protocol only, which the link finds out by asking. test_framed_link.cpp has the other.
std::unique_ptr<device::Board> board_on(const std::string& kind,
                                        device::DeviceConfiguration configuration = plain_board()) {
  configuration.protocol = device::Protocol::classic;
  auto board = std::make_unique<device::Board>(configuration, device::make_endpoint(kind, "127.0.0.1"));
  board->start();
  return board;
}

std::string with_options(const std::string& url, const std::string& options) {
  return url + (url.find('?') == std::string::npos ? "?" : "&") + options;
}

std::unique_ptr<Link> opened(const std::string& url) {
  std::unique_ptr<Link> link;
  const Outcome outcome = Link::open(url, link);
  CAPTURE(outcome.text);
  REQUIRE(outcome.ok());
  return link;
}

// Opens a link to a board that may not have noticed yet that its last client has left.
std::unique_ptr<Link> opened_again(device::Board& board, const std::string& options) {
  std::unique_ptr<Link> link;
  Outcome outcome;
  for (const std::uint64_t until = real_ns() + 10'000'000'000; !link && real_ns() < until; std::this_thread::yield()) {
    outcome = Link::open(with_options(board.url(), options), link);
  }
  CAPTURE(outcome.text);
  REQUIRE(link != nullptr);
  return link;
}

}  // namespace

TEST_CASE("reads, writes and publishes over every endpoint") {
  for (const char* kind : {"fd", "pty", "tcp", "udp"}) {
    CAPTURE(kind);
    const auto board = board_on(kind);
    const auto link = opened(with_options(board->url(), "fifo=1024&timeout=1"));
    CHECK(link->configuration().groups == 4);
    CHECK(link->usable_group_size() == 15);
    std::uint32_t value = 0;
    CHECK(link->write(0x20, 0xDEADBEEF, {}).ok());
    CHECK(link->read(0x20, value, {.checked = true, .repeat = true, .timeout_ns = 0}).ok());
    CHECK(value == 0xDEADBEEF);
    std::vector<std::uint32_t> addresses(100), written(100), values(100);
    for (std::uint32_t index = 0; index < 100; ++index) {
      addresses[index] = index;
      written[index] = 3 * index;
    }
    CHECK(link->write_many(addresses, written, {}).ok());
    CHECK(link->read_many(addresses, values, false, {}).ok());
    CHECK(values == written);
    values.assign(100, 0);
    CHECK(link->read_each(addresses, values, {}).ok());
    CHECK(values == written);
    CHECK(link->read_many(addresses, values, true, {}).status == Status::mismatch);

    std::uint32_t group = 9;
    const std::array<std::uint32_t, 2> published{3, 4};
    REQUIRE(link->subscribe({.addresses = published, .divisor = 1}, group).ok());
    CHECK(link->wait_publish(group, 1'000'000'000));
    std::array<double, 64> times{};
    std::array<std::uint32_t, 128> words{};
    const std::size_t count = link->drain(group, times, words);
    CHECK(count > 0);
    CHECK(words[0] == 9);
    CHECK(words[1] == 12);
    CHECK(link->read(0x21, value, {}).ok());  // while the reader thread uses the descriptor
    CHECK(link->unsubscribe(group).ok());
    CHECK(link->statistics().unclaimed_publishes < 1000);
  }
}

TEST_CASE("the C ABI, from C") {
  const auto board = board_on("fd");
  CHECK(abi_test(board->url().c_str()) == 0);
}

TEST_CASE("credit keeps a board with 16-byte FIFOs on a 3 MBd line from losing anything") {
  auto configuration = plain_board();
  configuration.baud_hz = 3'000'000;
  configuration.fifo = 16;
  configuration.honour_flush = true;
  const auto board = board_on("fd", configuration);
  const auto link = opened(with_options(board->url(), "timeout=2"));
  std::vector<std::uint32_t> addresses(64), written(64), values(64);
  for (std::uint32_t index = 0; index < addresses.size(); ++index) {
    addresses[index] = index;
    written[index] = 0x01010101 * index;
  }
  CHECK(link->write_many(addresses, written, {}).ok());
  CHECK(link->read_each(addresses, values, {}).ok());
  CHECK(values == written);
  values.assign(values.size(), 0);
  CHECK(link->read_many(addresses, values, false, {}).ok());
  CHECK(values == written);
  CHECK(link->statistics().retries == 0);
  CHECK(link->statistics().datalink_errors == 0);
}

TEST_CASE("threads share a link") {
  const auto board = board_on("fd");
  const auto link = opened(with_options(board->url(), "fifo=256&timeout=2"));
  std::vector<std::thread> threads;
  std::array<int, 4> wrong{};
  for (std::uint32_t thread = 0; thread < wrong.size(); ++thread) {
    threads.emplace_back([&, thread] {
      for (std::uint32_t turn = 0; turn < 300; ++turn) {
        std::uint32_t value = 0;
        const bool ok = link->write(thread, turn, {}).ok() && link->read(thread, value, {}).ok() && value == turn;
        wrong[thread] += ok ? 0 : 1;
      }
    });
  }
  for (std::thread& thread : threads) {
    thread.join();
  }
  CHECK(wrong == std::array<int, 4>{});
}

TEST_CASE("an address where nothing answers, and what may not be sent") {
  auto configuration = plain_board();
  configuration.silent_ranges = {{0x30, 0x30}};
  const auto board = board_on("fd", configuration);
  const auto link = opened(board->url());
  std::uint32_t value = 0;
  const Outcome silent = link->read(0x30, value, {});
  CHECK(silent.status == Status::bus_error);
  CHECK(silent.address == 0x30);
  CHECK(silent.text.find("0x30") != std::string::npos);
  std::array<std::uint32_t, 3> values{};
  const std::array<std::uint32_t, 3> addresses{0x10, 0x30, 0x11};
  const Outcome many = link->read_many(addresses, values, false, {});
  CHECK(many.status == Status::bus_error);
  CHECK(many.index == 1);
  CHECK(many.address == 0x30);
  std::uint32_t group = 0;
  CHECK(link->subscribe({.addresses = addresses, .divisor = 1}, group).status == Status::bus_error);
  CHECK(link->read(0x100, value, {}).status == Status::range);
  const std::vector<std::uint32_t> sixteen(16, 1);
  CHECK(link->subscribe({.addresses = sixteen, .divisor = 1}, group).status == Status::mismatch);
  CHECK(link->subscribe({.addresses = sixteen, .divisor = 0}, group).status != Status::ok);
  CHECK(link->subscribe({.addresses = std::span(sixteen).first(1), .divisor = 0}, group).status == Status::range);
  CHECK(link->subscribe({.addresses = std::span(sixteen).first(1), .divisor = 65536}, group).status == Status::range);
}

TEST_CASE("groups run out, and are free again") {
  const auto board = board_on("fd");
  const auto link = opened(board->url());
  const std::array<std::uint32_t, 1> address{1};
  std::array<std::uint32_t, 5> groups{};
  for (std::uint32_t index = 0; index < 4; ++index) {
    REQUIRE(link->subscribe({.addresses = address, .divisor = 10}, groups[index]).ok());
    CHECK(groups[index] == index);
  }
  CHECK(link->subscribe({.addresses = address, .divisor = 10}, groups[4]).status == Status::mismatch);
  CHECK(link->unsubscribe(2).ok());
  CHECK(link->subscribe({.addresses = address, .divisor = 10}, groups[4]).ok());
  CHECK(Link::group_of(groups[4]) == 2);
  CHECK(groups[4] != groups[2]);  // the old id does not name the new subscription
  CHECK(link->subscribed(groups[4]));
  CHECK_FALSE(link->subscribed(groups[2]));
  CHECK(link->words(groups[2]) == 0);
  CHECK_FALSE(link->wait_publish(groups[2], 3'600'000'000'000));
  CHECK(link->unsubscribe(groups[2]).ok());
  CHECK(link->subscribed(groups[4]));
}

TEST_CASE("another program's subscriptions are silenced only when this one subscribes") {
  const auto board = board_on("fd");
  const std::array<std::uint32_t, 1> address{1};
  std::uint32_t group = 0;
  {
    const int copy = std::stoi(board->url().substr(3));
    const char* left_behind = "#WSA:030101\n#WSR:030001\n#EPS\n";  // publishes group 3 at the full rate, then leaves
    REQUIRE(::write(copy, left_behind, std::string(left_behind).size()) > 0);
    std::string heard;
    for (pollfd waiting{copy, POLLIN, 0}; heard.find("S_EPS") == std::string::npos;) {
      REQUIRE(::poll(&waiting, 1, 10'000) == 1);
      std::array<char, 256> room{};
      heard.append(room.data(), static_cast<std::size_t>(std::max<ssize_t>(0, ::read(copy, room.data(), room.size()))));
    }
    ::close(copy);
  }
  const auto link = opened_again(*board, "timeout=1");
  std::uint32_t value = 0;
  for (const std::uint64_t until = real_ns() + 10'000'000'000; link->statistics().unclaimed_publishes == 0;) {
    REQUIRE(link->read(1, value, {}).ok());
    REQUIRE(real_ns() < until);
  }
  REQUIRE(link->subscribe({.addresses = address, .divisor = 1}, group).ok());
  const std::uint64_t unclaimed = link->statistics().unclaimed_publishes;
  for (std::uint64_t seen = 0, before = 0; seen < 20; before = seen) {
    seen = link->wait_publishes(seen, 10'000'000'000);
    REQUIRE(seen > before);
  }
  CHECK(link->statistics().unclaimed_publishes == unclaimed);
}

TEST_CASE("narrow words: written only where gateware can, which is asked once") {
  for (const std::uint32_t data_bits : {8u, 16u, 24u}) {
    CAPTURE(data_bits);
    auto configuration = plain_board();
    configuration.data_bits = data_bits;
    const auto board = board_on("fd", configuration);  // the twin is corrected gateware
    const std::uint32_t highest = (1u << data_bits) - 1;
    std::uint32_t value = 0;
    {
      const auto link = opened(board->url());
      const std::uint64_t before = link->statistics().requests;
      CHECK(link->read(1, value, {}).ok());
      CHECK(link->statistics().requests == before + 1);  // a read alone asks no further question
      CHECK(link->write(1, highest, {}).ok());
      CHECK(link->statistics().requests == before + 3);
      CHECK(link->write(2, 5, {}).ok());
      CHECK(link->statistics().requests == before + 4);
      CHECK(link->read(1, value, {}).ok());
      CHECK(value == highest);
      CHECK(link->write(1, highest + 1, {}).status == Status::range);
    }
    const auto told = opened_again(*board, "gateware=2012");
    CHECK(told->write(1, 2, {}).status == Status::mismatch);
    CHECK(told->read(1, value, {}).ok());
    CHECK(value == highest);
  }
}

TEST_CASE("gateware without RLC needs the widths in the URL; wrong ones are refused") {
  auto configuration = plain_board();
  configuration.configuration_command = false;
  const auto board = board_on("fd", configuration);
  std::unique_ptr<Link> link;
  Outcome outcome = Link::open(board->url(), link);
  CHECK(outcome.status == Status::mismatch);
  CHECK(outcome.text.find("address_bytes=") != std::string::npos);
  link = opened_again(*board, "address_bytes=1&data_bytes=4");
  CHECK_FALSE(link->configuration().discovered);
  CHECK(link->write(3, 77, {}).ok());
  std::uint32_t value = 0;
  CHECK(link->read(3, value, {}).ok());
  CHECK(value == 77);
  const auto other = board_on("fd");
  std::unique_ptr<Link> refused;
  CHECK(Link::open(with_options(other->url(), "address_bytes=2"), refused).status == Status::mismatch);
}

TEST_CASE("a second opener hears that the board is busy") {
  const auto board = board_on("tcp");
  const auto first = opened(board->url());
  std::unique_ptr<Link> second;
  for (const char* protocol : {"protocol=auto", "protocol=framed", "protocol=classic"})
    CHECK(Link::open(with_options(board->url(), protocol), second).status == Status::busy);
  const auto terminal = board_on("pty");
  const auto holder = opened(terminal->url());
  CHECK(Link::open(terminal->url(), second).status == Status::busy);
  first->close();
  const auto again = opened_again(*board, "timeout=1");
  CHECK_FALSE(again->closed());
}

TEST_CASE("a port that is gone is told at once, to those who wait too, and a new one can be opened") {
  for (const char* kind : {"pty", "tcp"}) {
    CAPTURE(kind);
    auto board = board_on(kind);
    const auto link = opened(with_options(board->url(), "timeout=5"));
    board.reset();
    std::uint32_t value = 0;
    const std::uint64_t begun = real_ns();
    CHECK(link->read(1, value, {}).status == Status::closed);
    CHECK(real_ns() - begun < 4'000'000'000);  // it did not wait for its timeout
    CHECK(link->closed());
    CHECK(link->read(1, value, {}).status == Status::closed);
  }
}

TEST_CASE("close wakes whoever waits; a silent device ends in a timeout that says all") {
  std::array<int, 2> ends{};
  REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) == 0);
  std::unique_ptr<Link> link;
  const std::string copy = std::to_string(::fcntl(ends[0], F_DUPFD_CLOEXEC, 0));
  // long enough for all attempts, also on a busy machine
  const Outcome silent = Link::open("fd:" + copy + "?timeout=0.1", link);
  CHECK(silent.status == Status::timeout);
  CHECK(silent.attempts == 3);
  CHECK(silent.text.find("never answered") != std::string::npos);

  const char* reply = "$CNF:01,04,20,02,03e8,02,10,02*a7\n";
  REQUIRE(::write(ends[1], reply, std::string(reply).size()) > 0);
  link = opened("fd:" + std::to_string(ends[0]) + "?timeout=60&protocol=classic");
  Outcome outcome;
  std::thread reader([&] {
    std::uint32_t value = 0;
    outcome = link->read(1, value, {});
  });
  while (link->statistics().requests == 0) {
    std::this_thread::yield();
  }
  link->close();
  reader.join();
  CHECK(outcome.status == Status::closed);
  ::close(ends[1]);
}

TEST_CASE("publishes that a serial line cannot carry are refused") {
  std::array<int, 2> ends{};
  REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) == 0);
  struct SlowDriver final : DescriptorDriver {
    using DescriptorDriver::DescriptorDriver;
    std::uint64_t byte_time_ns() const noexcept override { return 1'000'000; }  // 10 kBd
  };
  const char* reply = "$CNF:01,04,20,02,03e8,02,10,02*a7\n";
  REQUIRE(::write(ends[1], reply, std::string(reply).size()) > 0);
  std::unique_ptr<Link> link;
  LinkOptions classic;
  classic.protocol = Protocol::classic;
  REQUIRE(Link::open(std::make_unique<SlowDriver>(ends[0]), classic, link).ok());
  const std::array<std::uint32_t, 1> address{1};
  std::uint32_t group = 0;
  const Outcome outcome = link->subscribe({.addresses = address, .divisor = 20}, group);  // 50 Hz of 21 bytes
  CHECK(outcome.status == Status::mismatch);
  CHECK(outcome.text.find("1050 bytes/s, the line carries 1000") != std::string::npos);
  ::close(ends[1]);
}

TEST_CASE("URLs that mean nothing say what was expected") {
  std::unique_ptr<Link> link;
  for (const char* url : {"",
                          "tcp",
                          "tcp:",
                          "tcp://host",
                          "tcp://:1",
                          "tcp://h:0",
                          "tcp://h:70000",
                          "fd:x",
                          "fd:",
                          "serial:",
                          "http://x:1",
                          "fd:0?x",
                          "fd:0?crc",
                          "fd:0?crc=2",
                          "fd:0?crc=1&crc=1",
                          "fd:0?timeout=0",
                          "fd:0?timeout=nan",
                          "fd:0?fifo=0",
                          "fd:0?fifo=1,",
                          "fd:0?polynomial=256",
                          "fd:0?polynomial=none&crc=1",
                          "fd:0?polynomial=none&protocol=framed",
                          "fd:0?colour=red",
                          "fd:0?window=0",
                          "fd:0?gateware=new",
                          "fd:0?baud=9600",
                          "fd:0?attempts=0",
                          "fd:0?data_bytes=5",
                          "fd:0?spin=1",
                          "fd:0?spin=-1"}) {
    CAPTURE(url);
    const Outcome outcome = Link::open(url, link);
    CHECK(outcome.status == Status::bad_url);
    CHECK(outcome.text.size() > 20);
  }
  CHECK(Link::open("serial:/dev/no-such-port", link).status == Status::not_found);
  CHECK(Link::open("serial:/dev/null", link).status == Status::not_found);
  CHECK(Link::open("fd:1000000", link).status == Status::not_found);
  CHECK(Link::open("tcp://127.0.0.1:1?timeout=0.2", link).status == Status::not_found);
  CHECK(Link::open("udp://127.0.0.1:1?timeout=0.05", link).status == Status::not_found);
}

TEST_CASE("an overrun is told as one, and not as the silence of another request of the call") {
  auto configuration = plain_board();
  configuration.baud_hz = 3'000'000;
  configuration.fifo = 4;
  for (const bool old : {false, true}) {
    for (const bool flush : {false, true}) {
      CAPTURE(old);
      CAPTURE(flush);
      configuration.published_2012 = old;
      configuration.honour_flush = flush;
      const auto board = board_on("fd", configuration);
      const auto link = opened(with_options(board->url(), "fifo=256&timeout=2&protocol=classic"));
      std::vector<std::uint32_t> addresses(60), values(60);
      for (std::uint32_t index = 0; index < addresses.size(); ++index) {
        addresses[index] = index;
      }
      const Outcome outcome = link->read_each(addresses, values, {.checked = {}, .repeat = true});
      CAPTURE(outcome.text);
      CHECK(outcome.status == Status::protocol_error);
      if (!old) {  // 2012 gateware first answers the requests that are complete, so it may report the damage first
        CHECK(outcome.text.find("it said ?f9 (more requests came than its receive FIFO holds") != std::string::npos);
        CHECK(outcome.text.find("fifo=") != std::string::npos);
      }
    }
  }
}

TEST_CASE("gateware without checksums: the URL keeps every '$' from it, and from the question about narrow words") {
  auto configuration = plain_board();
  configuration.checksum = device::Checksum::none;
  configuration.published_2012 = true;
  configuration.data_bits = 16;
  const auto board = board_on("fd", configuration);
  std::unique_ptr<Link> refused;
  Outcome outcome = Link::open(with_options(board->url(), "timeout=0.05"), refused);
  CHECK(outcome.status == Status::protocol_error);
  CHECK(outcome.text.find("polynomial=none") != std::string::npos);
  const auto link = opened_again(*board, "polynomial=none");
  std::uint32_t value = 7;
  CHECK(link->read(1, value, {}).ok());
  CHECK(value == 0);
  CHECK(link->read(1, value, {.checked = true}).status == Status::mismatch);
  outcome = link->write(1, 2, {});
  CHECK(outcome.status == Status::mismatch);
  CHECK(outcome.text.find("gateware=2012 or gateware=corrected") != std::string::npos);
  CHECK(link->statistics().datalink_errors == 0);  // each '$' would have caused one
}
