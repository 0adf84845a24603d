// SPDX-License-Identifier: BSD-3-Clause
// Time in steps: members work in the order of their dues, and never past what the one who waits waits for.
#include <doctest/doctest.h>

#include <array>
#include <string>
#include <sys/eventfd.h>
#include <unistd.h>

#include "layer0_driver/lockstep.hpp"
#include "layer0_driver/robot_time.hpp"

using unitylink::Lockstep;
using unitylink::RobotTime;

namespace {

// Works every `period_ns`, and says so in a common record. After `last` works it makes a descriptor readable.
class Ticker final : public Lockstep::Member {
 public:
  Ticker(std::string& record, char name, std::uint64_t period_ns)
      : record_(record), name_(name), period_ns_(period_ns) {
    due_ns_ = RobotTime::here().now_ns() + period_ns;
    Lockstep::here().join(*this);
  }
  ~Ticker() override { Lockstep::here().leave(*this); }

  [[nodiscard]] std::uint64_t due_ns() noexcept override { return due_ns_; }
  void take_in() noexcept override {}
  void work(std::uint64_t until_ns) noexcept override {
    CHECK(RobotTime::here().now_ns() == due_ns_);
    CHECK(until_ns >= due_ns_);
    record_ += name_;
    due_ns_ = --left == 0 ? RobotTime::idle : due_ns_ + period_ns_;
    if (rings >= 0 && left == 0) {
      const std::uint64_t one = 1;
      CHECK(::write(rings, &one, sizeof one) == sizeof one);
    }
    if (gives_news_to != nullptr && left == 0) {
      gives_news_to->has_news_ = true;
    }
  }
  [[nodiscard]] bool has_news() noexcept override { return has_news_; }
  void set_due(std::uint64_t due_ns) { due_ns_ = due_ns; }

  int left = 1000;
  int rings = -1;
  Ticker* gives_news_to = nullptr;

 private:
  bool has_news_ = false;
  std::string& record_;
  char name_;
  std::uint64_t period_ns_;
  std::uint64_t due_ns_;
};

class Stepped {
 public:
  Stepped() { RobotTime::here().claim(true); }
  ~Stepped() {
    RobotTime::here().release(true);
    ::close(event_);
  }
  int advance(std::uint64_t ns, Lockstep::Member* self = nullptr) {
    return Lockstep::here().advance(ns, waiting_, self);
  }
  [[nodiscard]] int event() const { return event_; }

 private:
  int event_ = ::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC);
  std::array<pollfd, 1> waiting_{pollfd{event_, POLLIN, 0}};
};

constexpr std::uint64_t stepped_start = RobotTime::stepped_start_ns;

}  // namespace

TEST_CASE("in steps, robot time begins at one second and stands still") {
  Stepped stepped;
  CHECK(RobotTime::here().now_ns() == stepped_start);
  CHECK(RobotTime::here().now_ns() == stepped_start);
  CHECK_THROWS_AS(RobotTime::here().claim(false), unitylink::TimeConflict);
}

TEST_CASE("members work in the order of their dues, and time goes no further than it is waited for") {
  Stepped stepped;
  std::string record;
  Ticker quick(record, 'q', 300);
  Ticker slow(record, 's', 700);
  CHECK(stepped.advance(stepped_start + 1500) == 0);
  CHECK(record == "qqsqqs");  // at 300 600 700 900 1200 1400, and 1500 is not over yet
  CHECK(RobotTime::here().now_ns() == stepped_start + 1500);
  CHECK(stepped.advance(stepped_start + 1400) == 0);  // it never goes back
  CHECK(RobotTime::here().now_ns() == stepped_start + 1500);
}

TEST_CASE("the one who waits does not work for itself, and wakes in the moment of the news") {
  Stepped stepped;
  std::string record;
  Ticker self(record, 'x', 100);
  Ticker other(record, 'o', 250);
  other.left = 2;
  other.rings = stepped.event();
  CHECK(stepped.advance(stepped_start + 1'000'000, &self) == 1);
  CHECK(record == "oo");
  CHECK(RobotTime::here().now_ns() == stepped_start + 500);
}

TEST_CASE("news need no descriptor") {
  Stepped stepped;
  std::string record;
  Ticker self(record, 'x', 100);
  Ticker other(record, 'o', 250);
  other.left = 2;
  other.gives_news_to = &self;
  CHECK(Lockstep::here().advance(stepped_start + 1'000'000, {}, &self) == 1);
  CHECK(record == "oo");
  CHECK(RobotTime::here().now_ns() == stepped_start + 500);
}

TEST_CASE("a member that was touched is asked again, and others are not") {
  Stepped stepped;
  std::string record;
  Ticker touched(record, 't', 1000);
  Ticker left_alone(record, 'l', 1000);
  CHECK(stepped.advance(stepped_start + 100) == 0);
  touched.set_due(stepped_start + 300);
  left_alone.set_due(stepped_start + 300);
  Lockstep::here().touch(touched);
  CHECK(stepped.advance(stepped_start + 999) == 0);
  CHECK(record == "t");
  left_alone.set_due(stepped_start + 1000);
  CHECK(stepped.advance(stepped_start + 1001) == 0);
  CHECK(record == "tl");
}

TEST_CASE("a member may leave in its own work, and the others stay") {
  class Leaving final : public Lockstep::Member {
   public:
    [[nodiscard]] std::uint64_t due_ns() noexcept override { return stepped_start + 200; }
    void take_in() noexcept override {}
    void work(std::uint64_t) noexcept override { Lockstep::here().leave(*this); }
  };
  Stepped stepped;
  std::string record;
  Leaving leaving;
  Lockstep::here().join(leaving);
  Ticker stays(record, 's', 300);
  CHECK(stepped.advance(stepped_start + 1000) == 0);
  CHECK(record == "sss");
  Lockstep::here().touch(leaving);  // it means nothing
  CHECK(stepped.advance(stepped_start + 1300) == 0);
  CHECK(record == "ssss");
}

TEST_CASE("with nothing due, a wait without an end gives way, and one with an end jumps there") {
  Stepped stepped;
  CHECK(stepped.advance(RobotTime::idle) == 0);
  CHECK(RobotTime::here().now_ns() == stepped_start);
  CHECK(stepped.advance(stepped_start + 3'600'000'000'000) == 0);
  CHECK(RobotTime::here().now_ns() == stepped_start + 3'600'000'000'000);
}

TEST_CASE("a member that is always due and does nothing does not stop time") {
  class Stuck final : public Lockstep::Member {
   public:
    [[nodiscard]] std::uint64_t due_ns() noexcept override { return stepped_start; }
    void take_in() noexcept override {}
    void work(std::uint64_t) noexcept override {}
  };
  Stepped stepped;
  Stuck stuck;
  Lockstep::here().join(stuck);
  CHECK(stepped.advance(stepped_start + 5'000) == 0);
  CHECK(RobotTime::here().now_ns() == stepped_start + 5'000);
  Lockstep::here().leave(stuck);
}
