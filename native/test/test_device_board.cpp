// SPDX-License-Identifier: BSD-3-Clause
// The board's thread, while other threads call all that may be called at the same time.
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>
#include <vector>

#include "device/board.hpp"
#include "device/word_plant.hpp"
#include "device_bench.hpp"

using namespace unitylink::device;

namespace {

int dial(const std::string& url) {
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(std::stoi(url.substr(url.rfind(':') + 1))));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const int client = ::socket(AF_INET, SOCK_STREAM, 0);
  REQUIRE(::connect(client, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0);
  const timeval patience{10, 0};
  ::setsockopt(client, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  return client;
}

std::string ask(int client, std::string_view request, std::size_t size) {
  REQUIRE(::send(client, request.data(), request.size(), MSG_NOSIGNAL) == static_cast<ssize_t>(request.size()));
  std::string reply;
  while (reply.size() < size) {
    char bytes[256];
    const ssize_t count = ::recv(client, bytes, std::min(sizeof bytes, size - reply.size()), 0);
    if (count <= 0) {
      break;
    }
    reply.append(bytes, static_cast<std::size_t>(count));
  }
  return reply;
}

}  // namespace

TEST_CASE("a board serves while plants, registers, events and statistics are used from other threads") {
  Board board(DeviceConfiguration{}, make_endpoint("tcp", "127.0.0.1"));
  std::atomic<int> steps = 0;
  board.set_plant({0.0005, [&board, &steps](double) {
                     board.set(1, static_cast<std::uint32_t>(++steps));
                     return true;
                   }});
  board.start();
  std::atomic<bool> done = false;
  std::thread other([&] {
    while (!done) {
      board.set(2, board.get(1).value);
      board.pulse_event(0);
      board.receive_error(0);
      static_cast<void>(board.statistics());
      static_cast<void>(board.time_s());
      static_cast<void>(board.url());
    }
  });
  const int client = dial(board.url());
  for (int i = 0; i < 300; ++i) {
    CHECK(ask(client, "#R:00\n", 14) == "#S_R:00000000\n");
  }
  while (steps < 5) {
    std::this_thread::yield();
  }
  done = true;
  other.join();
  ::close(client);
  board.stop();
  board.stop();
  CHECK(board.statistics().plant_steps >= 5);
  CHECK_THROWS_AS(static_cast<void>(board.url()), EndpointError);
}

TEST_CASE("clients come and go, and the board remembers what they set") {
  Board board(DeviceConfiguration{}, make_endpoint("tcp", "127.0.0.1"));
  board.start();
  for (int i = 0; i < 20; ++i) {
    const int client = dial(board.url());
    char request[32];
    std::snprintf(request, sizeof request, "#W:10%08x\n#R:10\n", i);
    char reply[32];
    std::snprintf(reply, sizeof reply, "#S_W\n#S_R:%08x\n", i);
    CHECK(ask(client, request, 19) == reply);
    const int second = dial(board.url());
    CHECK(ask(second, "", 6) == "?busy\n");
    ::close(second);
    ::close(client);
  }
  CHECK(board.get(0x10).value == 19);
  CHECK(board.statistics().clients == 20);
}

TEST_CASE("a board takes the place of one that was killed, whose link is left behind") {
  const std::string path = "/tmp/unitylink-killed-" + std::to_string(::getpid()) + ".tty";
  int ready[2];
  REQUIRE(::pipe(ready) == 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto endpoint = make_endpoint("pty:" + path, "");
    static_cast<void>(::write(ready[1], "!", 1) + ::pause());
    ::_exit(1);
  }
  char byte = 0;
  REQUIRE(::read(ready[0], &byte, 1) == 1);
  CHECK_THROWS_AS(make_endpoint("pty:" + path, ""), EndpointError);  // its process still runs
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  CHECK(make_endpoint("pty:" + path, "")->url() == "serial:" + path);
  ::close(ready[0]);
  ::close(ready[1]);
}

TEST_CASE("a board whose thread sleeps is up to date for a caller") {
  Board board(DeviceConfiguration{}, make_endpoint("tcp", "127.0.0.1"));
  board.set_plant(0.001, WordPlant({{0x10, 0, 1U << 30, 1000.0}}, {{0x10, 0x20}}));
  board.start();
  const std::uint32_t first = board.get(0x10).value;
  std::uint32_t then = first;
  for (int turn = 0; turn < 10'000 && then < first + 20; ++turn) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    then = board.get(0x10).value;
  }
  CHECK(then >= first + 20);
  const std::uint32_t echo = board.get(0x20).value;
  CHECK(echo >= then);
  CHECK(board.time_s() >= echo * 0.001);
  CHECK(board.statistics().plant_steps >= echo);
}

TEST_CASE("words that count and words that echo") {
  Device device(DeviceConfiguration{});
  const WordPlant plant({{0x10, -3, 6, 10.0}}, {{0x20, 0x21}});
  device.set(0x20, 77);
  std::vector<std::int32_t> seen;
  for (int tick = 0; tick < 14; ++tick) {
    plant.step(device, tick * 0.1 + 0.05);
    seen.push_back(static_cast<std::int32_t>(device.get(0x10).value));
  }
  CHECK(seen == std::vector<std::int32_t>{-3, -2, -1, 0, 1, 2, -3, -2, -1, 0, 1, 2, -3, -2});
  CHECK(device.get(0x21).value == 77);
}
