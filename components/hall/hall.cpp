// SPDX-License-Identifier: BSD-3-Clause
// The model of hall.vhd.
#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "device/component/component.hpp"
#include "device/component/edge_velocity.hpp"
#include "device/component/input_filter.hpp"

namespace unitylink::device {

namespace {

class Hall final : public Component {
 public:
  explicit Hall(const ComponentConfiguration& from)
      : Component(from, std::string(from.generic("with_velocity", 0) != 0 ? 5 : 4, '0'), false),
        with_velocity_(from.generic("with_velocity", 0) != 0),
        filter_(3, InputFilter::lasting(from.generic("filter_ns", 1000), from.generic("clock_hz", 50'000'000))),
        speed_(from, from.generic("velocity_us", 1000), from.generic("stall_us", 100'000), false) {
    while (from.generic("clock_hz", 50'000'000) / static_cast<std::int64_t>(tick_clocks_) >= 2'000'000) {
      tick_clocks_ *= 2;
    }
  }

 private:
  enum Register : std::uint32_t { status, position, angle, failures, velocity };
  enum Event : std::uint32_t { moved, failed, stopped };
  enum Wire : std::uint32_t { position_wire, angle_wire, velocity_wire };
  static constexpr std::int32_t steps = 64;  // of the angle in a sector
  static constexpr std::uint32_t step_size = 171;
  static constexpr std::int32_t time_full = steps - 65'535;

  // The sector of each code of the lines.
  static constexpr std::array<std::optional<std::uint32_t>, 8> sector_of{std::nullopt, 1, 3, 2, 5, 0, 4, std::nullopt};

  [[nodiscard]] static std::uint32_t twelfth(std::uint32_t number) noexcept {
    return (number % 12 * 65'536 + 6) / 12 & 0xFFFFu;
  }
  // The edge of tick `number` from the next one on.
  [[nodiscard]] Clock nth_tick(std::int32_t number) const noexcept {
    return (ticks_ + static_cast<Clock>(number)) * tick_clocks_ + tick_clocks_ - 1;
  }

  [[nodiscard]] Clock next() const noexcept override {
    Clock soonest = std::min(look_, filter_.next());
    if (with_velocity_) {
      soonest = std::min(soonest, speed_.next());
    }
    if (timed_ || runs_) {
      soonest = std::min(soonest, nth_tick(passed_ - time_full));
    }
    if (runs_ && taken_ != steps - 1) {
      soonest = std::min(soonest, nth_tick(due_ >= 0 ? 0 : (steps - 1 - due_) / steps));
    }
    return soonest;
  }

  void step(Clock edge) override {
    const std::int32_t speed = speed_.value();
    look_ = never;
    if (with_velocity_) {
      measure(edge);
    }
    const auto whole =
        static_cast<std::int32_t>(std::min<Clock>(edge / tick_clocks_ - ticks_, static_cast<Clock>(steps - time_full)));
    ticks_ = edge / tick_clocks_;
    passed_ = std::max(passed_ - whole, time_full);
    due_ += runs_ && taken_ != steps - 1 ? whole * steps : 0;
    const std::optional<std::uint32_t> found = sector_of[filter_.levels()];
    const bool turns = found && (!known_ || *found != sector_);
    const std::int32_t passed = passed_;
    const bool was_timed = timed_;
    if (edge % tick_clocks_ == tick_clocks_ - 1) {
      tick();
    }
    if (turns) {
      turn(*found, passed, was_timed, edge);
    } else if (!found && !bad_) {
      fail(edge);
    }
    bad_ = !found;
    if (filter_.step(edge)) {
      look_ = edge + 1;
    }
    if (speed_.value() != speed) {
      look_ = edge + 1;
    }
    tell(speed, edge);
  }

  void measure(Clock edge) {
    speed_.tick(edge);
    const std::int32_t way = std::exchange(way_, 0);
    if (way != 0) {
      speed_.moved(edge, way > 0);
    }
    if (speed_.stalls(edge, way != 0)) {
      event(stopped, edge);
    }
  }

  // Of the state before this edge.
  void tick() noexcept {
    ++ticks_;
    const bool is_full = passed_ == time_full;
    if (is_full && timed_) {
      angle_ = twelfth(2 * sector_ + 1);
    }
    if (runs_ && taken_ != steps - 1) {
      if (due_ >= 0) {
        due_ += period_;
        ++taken_;
        angle_ = (angle_ + (back_ ? 0x10000u - step_size : step_size)) & 0xFFFFu;
      } else {
        due_ += steps;
      }
    }
    if (is_full) {
      timed_ = runs_ = false;
    } else {
      --passed_;
    }
  }

  // The rotor is in another sector, or in the first one.
  void turn(std::uint32_t found, std::int32_t passed, bool was_timed, Clock edge) {
    const bool up = known_ && found == (sector_ + 1) % 6;
    const bool down = known_ && sector_ == (found + 1) % 6;
    std::uint32_t place = 2 * found + 1;
    runs_ = false;
    timed_ = up || down;
    taken_ = 0;
    passed_ = steps;
    if (known_) {
      event(moved, edge);
    }
    if (up || down) {
      period_ = due_ = passed;
      if (was_timed && back_ == down) {
        runs_ = true;
        place = down ? 2 * sector_ : 2 * found;
      }
      back_ = down;
      way_ = up ? 1 : -1;
      position_ += static_cast<std::uint32_t>(way_);
      look_ = edge + 1;
    } else if (known_) {
      fail(edge);
    }
    known_ = true;
    sector_ = found;
    angle_ = twelfth(place);
  }

  void fail(Clock edge) {
    ++failures_;
    event(failed, edge);
  }

  void tell(std::int32_t speed, Clock edge) {
    const bool valid = !bad_;
    word(status, sector_ | (valid ? 8u : 0u) | (back_ ? 16u : 0u) | (runs_ ? 32u : 0u), edge);
    word(position, position_, edge);
    word(angle, angle_, edge);
    word(failures, failures_ & 0xFFFFu, edge);
    wire(position_wire, {position_, valid}, edge);
    wire(angle_wire, {angle_, valid}, edge);
    if (with_velocity_) {
      word(velocity, static_cast<std::uint32_t>(speed), edge);
      wire(velocity_wire, {static_cast<std::uint32_t>(speed), valid}, edge);
    }
  }

  void driven(std::uint32_t pin, bool level, Clock edge) override { filter_.drive(pin, level, edge); }

  bool with_velocity_;
  InputFilter filter_;
  EdgeVelocity speed_;
  Clock tick_clocks_ = 1;
  Clock ticks_ = 0;  // that have been counted
  std::uint32_t sector_ = 0;
  std::uint32_t position_ = 0;
  std::uint32_t failures_ = 0;
  std::uint32_t angle_ = 0;
  std::int32_t passed_ = steps;  // 64 less the ticks since the last edge
  std::int32_t period_ = 0;
  std::int32_t due_ = 0;  // a step of the angle comes when it is not negative
  std::int32_t taken_ = 0;
  std::int32_t way_ = 0;  // that the velocity has not seen yet
  bool known_ = false;
  bool bad_ = false;
  bool timed_ = false;
  bool back_ = false;
  bool runs_ = false;
  Clock look_ = 0;
};

}  // namespace

std::unique_ptr<Component> make_hall(const ComponentConfiguration& from) { return std::make_unique<Hall>(from); }

}  // namespace unitylink::device
