// SPDX-License-Identifier: BSD-3-Clause
// A line that comes back, used by several threads. The board counts the writes that it executes: none may be executed
// twice, and none that was confirmed may be missing.
#include <doctest/doctest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "device/board.hpp"
#include "device/endpoints.hpp"
#include "layer2_message/link.hpp"

using namespace unitylink;

namespace {

constexpr std::uint32_t fifo = 0x40;  // a FIFO, so the board keeps each write
constexpr int losses = 60;
constexpr RequestOptions again = {.checked = std::nullopt, .repeat = true, .timeout_ns = 0};

device::DeviceConfiguration with_fifo() {
  device::DeviceConfiguration made;
  made.fifos.push_back({.base = fifo, .depth = 65536});
  return made;
}

struct Desk {
  explicit Desk(const std::string& options) : board(with_fifo(), device::make_endpoint("tcp", "127.0.0.1")) {
    board.start();
    outcome = Link::open(board.url() + "?timeout=5&reconnect=1&" + options, link);
  }
  std::vector<std::uint32_t> written() {
    std::vector<std::uint32_t> found(board.get(fifo + 1).value);
    for (std::uint32_t& word : found) word = board.get(fifo).value;
    return found;
  }
  device::Board board;
  std::unique_ptr<Link> link;
  Outcome outcome;
};

struct Writer {
  std::vector<std::uint32_t> done, refused;
  std::size_t unknown = 0;
};

}  // namespace

TEST_CASE("no set-point is repeated and no execution forgotten, however often the line is lost") {
  for (const char* options : {"wait=30&protocol=framed", "wait=30&protocol=classic"}) {
    Desk desk(options);
    REQUIRE(desk.outcome.ok());
    std::atomic<bool> over = false;
    std::vector<Writer> writers(8);  // enough threads, so that some write is always executed but not yet answered
    std::vector<std::thread> threads;
    for (std::uint32_t first = 0; first < writers.size(); ++first) {
      threads.emplace_back([&, first] {
        Writer& mine = writers[first];
        for (std::uint32_t number = first; !over; number += static_cast<std::uint32_t>(writers.size())) {
          const Outcome told = desk.link->write(fifo, number, {});
          if (told.ok()) mine.done.push_back(number);
          if (told.status == Status::down) mine.refused.push_back(number);
          mine.unknown += told.status == Status::unknown ? 1 : 0;
          if (!told.ok()) static_cast<void>(desk.link->wait_up(30'000'000'000));
        }
      });
    }
    for (int lost = 1; lost <= losses; ++lost) {
      // so that the line breaks in another request each time
      std::this_thread::sleep_for(std::chrono::microseconds(150 * (lost % 7)));
      desk.board.hang_up();
      while (desk.link->statistics().reconnections < static_cast<std::uint64_t>(lost)) std::this_thread::yield();
      REQUIRE(desk.link->wait_up(30'000'000'000).ok());
    }
    over = true;
    for (std::thread& thread : threads) thread.join();
    const std::vector<std::uint32_t> all = desk.written();
    std::size_t unknown = 0;
    for (std::uint32_t first = 0; first < writers.size(); ++first) {
      const Writer& mine = writers[first];
      std::vector<std::uint32_t> written;
      std::copy_if(all.begin(), all.end(), std::back_inserter(written),
                   [&](std::uint32_t number) { return number % writers.size() == first; });
      CAPTURE(options);
      CHECK(std::is_sorted(written.begin(), written.end()));                       // no write was executed late
      CHECK(std::adjacent_find(written.begin(), written.end()) == written.end());  // none twice
      // each confirmed write was executed
      CHECK(std::includes(written.begin(), written.end(), mine.done.begin(), mine.done.end()));
      CHECK(std::none_of(mine.refused.begin(), mine.refused.end(), [&](std::uint32_t number) {
        return std::binary_search(written.begin(), written.end(), number);
      }));
      CHECK(written.size() <= mine.done.size() + mine.unknown);
      unknown += mine.unknown;
    }
    CHECK(all.size() > losses);
    CHECK(unknown > 0);  // otherwise no write was in flight at any loss
  }
}

TEST_CASE("a program that gives no sign of life loses its line, and has it back") {
  Desk desk("protocol=framed");
  REQUIRE(desk.outcome.ok());
  REQUIRE(desk.link->watch_program(0.05).ok());
  std::uint32_t word = 0;
  Outcome told;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(5);
  while ((told = desk.link->read(0x20, word, again)).ok() && std::chrono::steady_clock::now() < end) {}
  CHECK(told.status == Status::down);
  CHECK(told.text.find("no sign of life") != std::string::npos);
  CHECK(desk.link->wait_up(100'000'000).status == Status::down);
  REQUIRE(desk.link->watch_program(30).ok());
  desk.link->alive();
  CHECK(desk.link->wait_up(30'000'000'000).ok());
  CHECK(desk.link->read(0x20, word, again).ok());
  CHECK(desk.link->watch_program(-1).status == Status::range);
}
