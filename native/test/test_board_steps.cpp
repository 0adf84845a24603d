// SPDX-License-Identifier: BSD-3-Clause
// Boards and links in steps: one thread runs them all, other threads may touch them, and a state goes to a new board.
#include <doctest/doctest.h>

#include <atomic>
#include <memory>
#include <random>
#include <thread>
#include <vector>

#include "device/board.hpp"
#include "layer2_message/link.hpp"

using unitylink::Link;
using unitylink::Outcome;
using unitylink::device::Board;
using unitylink::device::DeviceConfiguration;
using unitylink::device::Echo;
using unitylink::device::PlantHook;
using unitylink::device::Ramp;
using unitylink::device::WordPlant;

namespace {

struct SteppedDesk {
  explicit SteppedDesk(const PlantHook& plant = {}) {
    if (plant.step) {
      board.set_plant(plant);
    }
    board.start();
    const Outcome outcome = Link::open(board.url() + "?timeout=1", link);
    REQUIRE_MESSAGE(outcome.ok(), outcome.text);
  }
  [[nodiscard]] std::uint32_t read(std::uint32_t address) {
    std::uint32_t value = 0;
    const Outcome outcome = link->read(address, value, {});
    CHECK_MESSAGE(outcome.ok(), outcome.text);
    return value;
  }
  [[nodiscard]] Outcome step(std::uint64_t ns) { return link->pass(link->now_ns() + ns); }

  Board board{DeviceConfiguration{}, unitylink::device::make_endpoint("lockstep", "")};
  std::unique_ptr<Link> link;
};

constexpr std::uint64_t step_ms = 1'000'000;

// A plant of words, and what a client and a program beside it see of its board. A seed chooses what they do.
struct SeenWords {
  std::vector<double> times_s;  // of publishes
  std::vector<std::uint32_t> words;
  std::uint64_t steps = 0;

  bool operator==(const SeenWords&) const = default;
};

struct CountingPlant {
  double period_s;
  std::vector<Ramp> ramps;
  std::vector<Echo> echoes;

  // Each step as it would be without any knowledge of the words: with calls from outside.
  [[nodiscard]] PlantHook each_step(Board& board) const {
    return {period_s, [this, &board](double time_s) {
              for (const Ramp& ramp : ramps) {
                const auto count = static_cast<std::uint64_t>(time_s * ramp.pace_hz) % ramp.span;
                board.set(ramp.address, static_cast<std::uint32_t>(ramp.low) + static_cast<std::uint32_t>(count));
              }
              for (const Echo& echo : echoes) {
                board.set(echo.to, board.get(echo.from).value);
              }
              return true;
            }};
  }
};

SeenWords seen_of(const DeviceConfiguration& configuration, const CountingPlant& plant, bool all_steps, unsigned seed) {
  SeenWords seen;
  Board board(configuration, unitylink::device::make_endpoint("lockstep", ""));
  if (all_steps) {
    board.set_plant(plant.each_step(board));
  } else {
    board.set_plant(plant.period_s, WordPlant(plant.ramps, plant.echoes));
  }
  board.start();
  std::unique_ptr<Link> link;
  REQUIRE(Link::open(board.url() + "?timeout=1", link).ok());
  const std::vector<std::uint32_t> published{plant.ramps[0].address, plant.echoes[0].to};
  std::uint32_t id = 0;
  REQUIRE(link->subscribe({.addresses = published, .divisor = 7}, id).ok());
  std::minstd_rand random(seed);
  for (int turn = 0; turn < 120; ++turn) {
    const auto number = static_cast<std::uint32_t>(random() >> 3);
    std::uint32_t word = 0;
    switch (number % 8) {
      case 0: CHECK(link->write(plant.echoes[0].from, number, {}).ok()); break;
      case 1: static_cast<void>(link->write(0x400, 0, {})); break;  // a commit on a TosNet
      case 2:
        CHECK(link->read(plant.ramps[number / 8 % plant.ramps.size()].address, word, {}).ok());
        seen.words.push_back(word);
        break;
      case 3:
        CHECK(link->read(plant.echoes[0].to, word, {}).ok());
        seen.words.push_back(word);
        break;
      case 4:
        seen.words.push_back(board.get(plant.echoes[0].to).value);
        seen.words.push_back(board.get(plant.ramps[1].address).value);
        break;
      case 5: board.set(plant.ramps[0].address, number); break;
      case 6: board.set_node(2, number / 8 % 4 != 0); break;
      default: CHECK(link->pass(link->now_ns() + number % 9'000'000).ok()); break;
    }
  }
  board.set_node(2, true);
  CHECK(link->pass(link->now_ns() + 20 * step_ms).ok());
  const std::size_t count = link->available(id);
  std::vector<std::uint32_t> drained(count * published.size());
  seen.times_s.resize(count);
  CHECK(link->drain(id, seen.times_s, drained) == count);
  seen.words.insert(seen.words.end(), drained.begin(), drained.end());
  seen.steps = board.statistics().plant_steps;
  return seen;
}

}  // namespace

TEST_CASE("a board in steps answers at once, and its time goes as far as it is told") {
  SteppedDesk desk;
  const std::uint64_t begun_ns = desk.link->now_ns();
  CHECK(desk.link->write(0x10, 7, {}).ok());
  CHECK(desk.read(0x10) == 7);
  CHECK(desk.link->now_ns() - begun_ns < 10'000);
  CHECK(desk.step(5 * step_ms).ok());
  CHECK(desk.board.time_s() * 1e9 == doctest::Approx(static_cast<double>(desk.link->now_ns() - 1'000'000'000)));
}

TEST_CASE("many boards keep one time, and each plant makes its own steps") {
  std::vector<std::unique_ptr<SteppedDesk>> desks;
  std::vector<int> steps(8);
  for (int& count : steps) {
    desks.push_back(std::make_unique<SteppedDesk>(PlantHook{0.001, [&count](double) { return ++count > 0; }}));
  }
  for (int turn = 0; turn < 20; ++turn) {
    CHECK(desks[static_cast<std::size_t>(turn) % 8]->step(step_ms).ok());
    CHECK(desks[3]->link->write(0x10, static_cast<std::uint32_t>(turn), {}).ok());
  }
  for (std::size_t index = 0; index < desks.size(); ++index) {
    CHECK(std::abs(steps[index] - 21) <= 1);
    CHECK(desks[index]->read(0x10) == (index == 3 ? 19 : 0));
  }
}

TEST_CASE("a cut line ends the link, and the board takes the next one") {
  SteppedDesk desk;
  CHECK(desk.link->write(0x10, 7, {}).ok());
  desk.board.hang_up();
  std::uint32_t value = 0;
  CHECK(desk.link->read(0x10, value, {}).status == unitylink::Status::closed);
  CHECK(Link::open(desk.board.url() + "?timeout=1", desk.link).ok());
  CHECK(desk.read(0x10) == 7);
  CHECK(desk.board.statistics().clients == 2);
}

TEST_CASE("other threads may use a board while it is stepped, and close the link") {
  SteppedDesk desk;
  SteppedDesk other;
  std::atomic<bool> ends = false;
  std::thread touching([&] {
    for (std::uint32_t turn = 0; !ends; ++turn) {
      static_cast<void>(desk.board.set(0x20, turn));
      static_cast<void>(desk.board.time_s());
      other.board.pulse_event(0);
    }
  });
  for (int turn = 0; turn < 200; ++turn) {
    CHECK(desk.step(step_ms / 10).ok());
    static_cast<void>(other.read(0x10));
  }
  ends = true;
  touching.join();
  std::thread closing([&] { desk.link->close(); });
  while (desk.step(step_ms).ok()) {}
  closing.join();
  CHECK(desk.link->closed());
}

TEST_CASE("a plant that is held goes on as that of another board would have") {
  std::vector<double> times_s;
  const PlantHook plant{0.001, [&times_s](double time_s) {
                          times_s.push_back(time_s);
                          return true;
                        }};
  Board::PlantPhase phase;
  {
    SteppedDesk desk(plant);
    CHECK(desk.step(2'300'000).ok());
    phase = desk.board.plant_phase();
    times_s.clear();
    CHECK(desk.step(3 * step_ms).ok());
  }
  const std::vector<double> went_on = times_s;
  SteppedDesk desk(plant);
  desk.board.hold_plant();
  times_s.clear();
  CHECK(desk.step(50 * step_ms).ok());
  CHECK(times_s.empty());
  CHECK(desk.board.preset(0x10, 77) == unitylink::device::BusStatus::ok);
  desk.board.release_plant(phase);
  CHECK(desk.step(3 * step_ms).ok());
  CHECK(times_s == went_on);
  CHECK(times_s.size() == 3);
  CHECK(desk.read(0x10) == 77);
}

TEST_CASE("steps of words that nobody can see are left out, and all that is seen is the same") {
  const CountingPlant plain{0.001, {{0x88, -100, 200, 300.0}, {0x89, 0, 7, 1234.0}}, {{0x8C, 0x8A}}};
  CountingPlant odd = plain;
  odd.period_s = 0.00037;
  DeviceConfiguration memory;
  DeviceConfiguration line;
  line.baud_hz = 1'000'000;
  DeviceConfiguration fast_ring;
  fast_ring.tosnet.present = true;
  fast_ring.tosnet.nodes = {{2, 0xFF}};
  DeviceConfiguration slow_ring = fast_ring;
  slow_ring.tosnet.cycle_clocks = 137'123;  // longer than the plant's period
  unsigned seed = 0;
  for (const DeviceConfiguration& configuration : {memory, line, fast_ring, slow_ring}) {
    for (const CountingPlant& plant : {plain, odd}) {
      for (int turn = 0; turn < 3; ++turn) {
        ++seed;
        CAPTURE(seed);
        const SeenWords all = seen_of(configuration, plant, true, seed);
        const SeenWords few = seen_of(configuration, plant, false, seed);
        CHECK(few.times_s == all.times_s);
        CHECK(few.words == all.words);
        CHECK(few.steps == all.steps);
        CHECK(all.times_s.size() > 5);
      }
    }
  }
}
