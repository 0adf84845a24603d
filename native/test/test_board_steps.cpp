// SPDX-License-Identifier: BSD-3-Clause
// Boards and links in steps: one thread runs them all, other threads may touch them, and a state goes to a new board.
#include <doctest/doctest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "device/board.hpp"
#include "layer2_message/link.hpp"

using unitylink::Link;
using unitylink::Outcome;
using unitylink::device::Board;
using unitylink::device::PlantHook;

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

  Board board{unitylink::device::DeviceConfiguration{}, unitylink::device::make_endpoint("lockstep", "")};
  std::unique_ptr<Link> link;
};

constexpr std::uint64_t step_ms = 1'000'000;

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
