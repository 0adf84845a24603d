// SPDX-License-Identifier: BSD-3-Clause
// A board server whose thread waits for a board that does not answer, and what others do to it meanwhile. What clients
// see of a server is tested in Python (tests/unit/server).
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <string>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>
#include <vector>

#include "device/board.hpp"
#include "device/endpoints.hpp"
#include "layer0_driver/descriptor_driver.hpp"
#include "layer2_message/link.hpp"
#include "server/board_server.hpp"
#include "unitylink/protocol.hpp"

using namespace unitylink;
using namespace std::chrono_literals;

namespace {

namespace request_kind = protocol::request_kind;
constexpr std::uint32_t served_word = 0x20;
constexpr std::array<std::uint32_t, 1> served_words{served_word};

// Loses the frames of one kind, and calls `before_group` before it sends the first definition of a group.
class LosingDriver final : public DescriptorDriver {
 public:
  struct Line {
    std::atomic<int> kind = -1;   // of the frames that are lost; -1: none is
    std::atomic<int> passes = 0;  // so many of them pass before the next is lost
    std::atomic<int> lost = 0;
    std::mutex mutex;
    std::function<void()> before_group;

    void lose(std::uint8_t which) { kind = which; }
    void lose_after(int count) { passes = count; }
    void lose_nothing() { kind = -1; }
    void watch(std::function<void()> group) {
      const std::scoped_lock lock(mutex);
      before_group = std::move(group);
    }
  };

  LosingDriver(int descriptor, Line& line) : DescriptorDriver(descriptor), line_(line) {}

  Transfer send(std::span<const std::uint8_t> bytes) noexcept override {
    const std::scoped_lock lock(line_.mutex);
    for (auto begin = bytes.begin(); begin != bytes.end();) {
      const auto end = std::find(begin, bytes.end(), 0);
      const auto next = end == bytes.end() ? end : end + 1;
      if (begin != end && *begin == line_.kind && line_.passes-- <= 0) {
        line_.lost += 1;
      } else {
        if (begin != end && *begin == request_kind::define_group && line_.before_group) {
          std::exchange(line_.before_group, nullptr)();
        }
        static_cast<void>(DescriptorDriver::send({begin, next}));
      }
      begin = next;
    }
    return {bytes.size(), Status::ok};
  }

 private:
  Line& line_;
};

// Once muted, it neither sends nor receives: as a program that was killed, whose connection somebody else has.
class MutedDriver final : public DescriptorDriver {
 public:
  MutedDriver(int descriptor, const std::atomic<bool>& muted) : DescriptorDriver(descriptor), muted_(muted) {}
  Transfer send(std::span<const std::uint8_t> bytes) noexcept override {
    return muted_ ? Transfer{bytes.size(), Status::ok} : DescriptorDriver::send(bytes);
  }
  Transfer receive(std::span<std::uint8_t> room) noexcept override {
    return muted_ ? Transfer{0, Status::ok} : DescriptorDriver::receive(room);
  }

 private:
  const std::atomic<bool>& muted_;
};

struct ServedBoard {
  explicit ServedBoard(std::uint64_t timeout_ns = 2'000'000'000)
      : board(configuration(), device::make_endpoint("fd", "127.0.0.1")) {
    board.start();
    LinkOptions options;
    options.engine.timeout_ns = timeout_ns;
    REQUIRE(Link::open(std::make_unique<LosingDriver>(std::stoi(board.url().substr(3)), line), options, link).ok());
    server = std::make_unique<server::BoardServer>(*link, server::Addresses{});
  }
  static device::DeviceConfiguration configuration() {
    device::DeviceConfiguration made;
    made.groups = 4;
    made.safe_words = {{served_word, 0}};
    return made;
  }
  // The client's end of a connection to the server.
  [[nodiscard]] int entered() const {
    std::array<int, 2> ends{};
    REQUIRE(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()) == 0);
    const server::Addresses all({{0, 0xFF}});
    server->admit(server::Connection(Descriptor(ends[0])), "somebody", {all, all, all, true});
    return ends[1];
  }
  [[nodiscard]] std::unique_ptr<Link> client() const { return opened(entered()); }
  static std::unique_ptr<Link> opened(int descriptor) {
    std::unique_ptr<Link> made;
    REQUIRE(Link::open("fd:" + std::to_string(descriptor) + "?timeout=5", made).ok());
    return made;
  }
  [[nodiscard]] std::uint32_t word() { return board.get(served_word).value; }
  [[nodiscard]] bool tripped() const {
    std::uint32_t state = 0;
    REQUIRE(link->read_control(protocol::control::arm, std::span(&state, 1), {}).ok());
    return (state & 1) != 0;
  }

  device::Board board;
  LosingDriver::Line line;
  std::unique_ptr<Link> link;
  std::unique_ptr<server::BoardServer> server;
};

template <class Condition>
void until(const Condition& condition) {
  while (!condition()) {
    std::this_thread::sleep_for(1ms);
  }
}

Outcome subscribed(Link& link, std::uint32_t divisor, std::uint32_t& id) {
  return link.subscribe({.addresses = served_words, .divisor = divisor, .verify = false, .ring = 16}, id);
}

}  // namespace

TEST_CASE("a trip passes a group that the board does not confirm") {
  ServedBoard served;
  const auto client = served.client();
  REQUIRE(client->write(served_word, 7, {}).ok());
  served.line.lose(request_kind::define_group);
  std::uint32_t id = 0;
  auto group = std::async(std::launch::async, [&] { return subscribed(*client, 10, id); });
  until([&] { return served.line.lost > 0; });
  CHECK(served.server->trip({}).ok());
  CHECK(served.word() == 0);
  CHECK(served.server->report().groups == 0);
  served.line.lose_nothing();
  CHECK(group.get().ok());
  CHECK(served.server->report().trips == 1);
  CHECK(client->write(served_word, 8, {}).status == Status::denied);
}

TEST_CASE("the outputs of a client that dies are made safe before its groups end") {
  ServedBoard served;
  const int descriptor = served.entered();
  const auto client = ServedBoard::opened(descriptor);
  std::uint32_t id = 0;
  REQUIRE(client->set_dead_man(60, {}).ok());
  REQUIRE(client->write(served_word, 7, {}).ok());
  REQUIRE(subscribed(*client, 1000, id).ok());
  std::uint32_t word = 7;
  served.line.watch([&] { word = served.word(); });
  REQUIRE(::shutdown(descriptor, SHUT_RDWR) == 0);
  until([&] { return served.server->report().groups == 0; });
  served.server->close();
  CHECK(word == 0);
}

TEST_CASE("the outputs of a session that another one replaces are made safe before its groups end") {
  ServedBoard served;
  const int descriptor = served.entered();
  const int kept = ::dup(descriptor);
  std::atomic<bool> muted = false;
  LinkOptions options;
  options.attempts = 1;
  std::unique_ptr<Link> client;
  REQUIRE(Link::open(std::make_unique<MutedDriver>(descriptor, muted), options, client).ok());
  std::uint32_t id = 0;
  REQUIRE(client->set_dead_man(60, {}).ok());
  REQUIRE(client->write(served_word, 7, {}).ok());
  REQUIRE(subscribed(*client, 1000, id).ok());
  muted = true;
  std::uint32_t word = 7;
  served.line.watch([&] { word = served.word(); });
  const auto next = ServedBoard::opened(kept);
  CHECK(served.server->report().groups == 0);
  CHECK(word == 0);
  CHECK(next->write(served_word, 8, {}).status == Status::denied);
}

TEST_CASE("a trip wins against an arm that is under way") {
  ServedBoard served(300'000'000);
  const auto client = served.client();
  REQUIRE(client->write(served_word, 7, {}).ok());
  served.line.lose(request_kind::write_control);
  auto armed = std::async(std::launch::async, [&] { return served.server->arm({}); });
  until([&] { return served.line.lost > 0; });
  served.line.lose_nothing();
  CHECK(served.server->trip({}).ok());
  CHECK(armed.get().status == Status::denied);
  CHECK(served.tripped());
  CHECK(served.word() == 0);
  CHECK(client->write(served_word, 8, {}).status == Status::denied);
  REQUIRE(served.server->arm({}).ok());
  CHECK(!served.tripped());
  CHECK(client->write(served_word, 9, {}).ok());
}

TEST_CASE("an order that is done is told before the next one waits for the board") {
  ServedBoard served;
  const auto client = served.client();
  std::uint32_t id = 0, shared_id = 0, own_id = 0;
  const auto ordered = [&](std::uint32_t divisor, std::uint32_t& into) {
    return std::async(std::launch::async, [&served, divisor, &into] {
      return served.server->subscribe({.addresses = served_words, .divisor = divisor, .verify = false, .ring = 16},
                                      into);
    });
  };
  served.line.lose(request_kind::define_group);
  auto group = std::async(std::launch::async, [&] { return subscribed(*client, 10, id); });
  until([&] { return served.line.lost > 0; });
  // Both orders wait for the thread. The first one needs nothing of the board, the other one a group that is lost.
  auto shared = ordered(10, shared_id);
  std::this_thread::sleep_for(50ms);
  auto own = ordered(20, own_id);
  std::this_thread::sleep_for(50ms);
  served.line.lose_after(1);
  CHECK(shared.get().ok());
  CHECK(own.wait_for(0s) == std::future_status::timeout);
  served.line.lose_nothing();
  CHECK(own.get().ok());
  CHECK(group.get().ok());
}

TEST_CASE("a client that comes when the server has ended is sent away") {
  const ServedBoard served;
  served.server->close();
  const Descriptor end(served.entered());
  std::uint8_t byte = 0;
  CHECK(::recv(end.get(), &byte, 1, MSG_DONTWAIT) == 0);
}

TEST_CASE("stops, arms, groups, grants and clients that come and go at once leave a server whole") {
  ServedBoard served;
  server::BoardServer& server = *served.server;
  constexpr int rounds = 30;
  std::vector<std::thread> threads;
  for (std::uint32_t divisor : {5u, 7u}) {
    threads.emplace_back([&served, divisor] {
      for (int round = 0; round < rounds; ++round) {
        const auto client = served.client();
        std::uint32_t id = 0;
        static_cast<void>(client->set_dead_man(30, {}));
        static_cast<void>(client->write(served_word, divisor, {}));
        if (subscribed(*client, divisor, id).ok() && round % 2 == 0) {
          static_cast<void>(client->unsubscribe(id));
        }
      }
    });
  }
  threads.emplace_back([&server] {
    for (int round = 0; round < rounds; ++round) {
      std::uint32_t id = 0;
      if (server.subscribe({.addresses = served_words, .divisor = 5, .verify = false, .ring = 16}, id).ok()) {
        CHECK(server.unsubscribe(id).ok());
      }
    }
  });
  threads.emplace_back([&server] {
    for (int round = 0; round < rounds; ++round) {
      CHECK(server.trip({}).ok());
      static_cast<void>(server.arm({}));
    }
  });
  threads.emplace_back([&server] {
    for (int round = 0; round < rounds; ++round) {
      for (const server::ClientReport& client : server.report().clients) {
        static_cast<void>(server.set_grant(client.id, {}, std::nullopt));
      }
      static_cast<void>(server.silent(1'000'000'000));
      static_cast<void>(server.wait_news(1'000'000));
    }
  });
  for (std::thread& thread : threads) {
    thread.join();
  }
  until([&] { return server.report().clients.empty(); });
  CHECK(server.report().groups == 0);
  CHECK(server.trip({}).ok());
  CHECK(served.word() == 0);
  CHECK(served.tripped());
  CHECK(server.arm({}).ok());
  const auto client = served.client();
  CHECK(client->write(served_word, 9, {}).ok());
  CHECK(served.word() == 9);
}
