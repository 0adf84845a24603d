// SPDX-License-Identifier: BSD-3-Clause
// The model of stepgen_motion.vhd: slots of one clock, each of them one operation on a word. Its names are those of the
// VHDL. `play` is what the VHDL does in many whole base periods.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "stepgen_train.hpp"

namespace unitylink::device {

class StepgenMotion {
 public:
  static constexpr std::uint32_t most_axes = 8;
  enum Part : std::uint32_t { position, phase, latched, stamp, now };

  // What the others ask for in a clock.
  struct Asked {
    bool put_velocity = false;  // for `axis` and the bank that is not in use
    bool put_shift = false;
    std::uint32_t data = 0;
    std::uint32_t axis = 0;
    bool bank = false;
    bool look = false;
    std::uint32_t look_axis = 0;
    Part look_part = position;
    bool shift = false;
    std::uint32_t catches = 0;  // a bit for each axis
  };

  // What it tells in the same clock.
  struct Told {
    bool base = false, put = false, looked = false, shifted = false, stepped = false, down = false, late = false;
    std::uint32_t axis = 0;  // that stepped, or is late
    std::uint32_t caught = 0;
  };

  StepgenMotion(const ComponentConfiguration& from, const StepgenRates& rates) : rates_(rates), periods_(rates) {
    for (StepgenPulse& pulse : pulses_) {
      pulse.configure(from);
    }
    positions_at_ = phases_at + std::max(rates.axes, 3u);
    pins_ = ((1u << rates.axes) - 1u) << rates.axes;  // all go up at first
  }

  bool operator==(const StepgenMotion&) const = default;

  // Does a base period begin, with no operation under way?
  [[nodiscard]] bool begins() const noexcept { return slot_ == 0 && then_ == Kind::idle && last_ == Kind::idle; }
  [[nodiscard]] const StepgenPeriods& periods() const noexcept { return periods_; }
  // Only the time goes on.
  void pass(Clock clocks) noexcept { memory_[now][0] += static_cast<std::uint32_t>(clocks); }

  [[nodiscard]] std::uint32_t pins() const noexcept { return pins_; }  // STEP of each axis, then DIR of each
  [[nodiscard]] std::uint32_t word(std::uint32_t axis, Part part) const noexcept {
    return memory_[part][part == now ? 0 : axis];
  }
  [[nodiscard]] std::uint32_t look_data() const noexcept { return word_; }

  // Would a look be answered in this clock?
  [[nodiscard]] bool serves(const Asked& asked) const noexcept {
    return chosen(asked).kind == Kind::idle && !(stores() && to_last_.is(asked.look_part, asked.look_axis));
  }

  // The clocks while the words are cleared.
  void clock_pulses() noexcept {
    for (std::uint32_t axis = 0; axis < rates_.axes; ++axis) {
      clock_pulse(axis, false, false);
    }
  }

  Told clock(const Asked& asked) noexcept {
    Told told;
    const bool down = (sum_ >> 31) != 0;
    const bool ask = asks();
    const bool taken = ask && pulses_[axis_last_].takes(down);
    const bool store = stores();
    told.base = periods_.ends();
    told.stepped = taken;
    told.down = down;
    told.axis = axis_last_;
    told.late = ask && pulses_[axis_last_].is_late(down);
    told.shifted = last_ == Kind::shift;
    told.caught = last_ == Kind::latch_position ? 1u << axis_last_ : 0;

    const Operation work = chosen(asked);
    const Place from = work.kind == Kind::idle ? Place{asked.look_part, asked.look_axis} : work.from;
    const bool clash = store && to_last_.is(from.part, from.axis);
    told.looked = asked.look && work.kind == Kind::idle && !clash;
    told.put = (asked.put_velocity || asked.put_shift) && work.kind == Kind::idle;

    const std::uint32_t word_before = word_;
    const std::uint32_t term_before = term_;
    if (!clash) {
      word_ = memory_[from.part][from.axis];
    }
    if (store) {
      memory_[to_last_.part][to_last_.axis] = sum_;
    }
    if (told.put) {
      (asked.put_velocity ? velocities_[asked.bank ? 0 : 1][asked.axis] : shift_) = asked.data;
    } else {
      term_ = work.term;
    }
    const std::uint32_t mask = then_ == Kind::phase ? phase_mask() : ~0u;
    sum_ = (word_before & mask) + term_before;
    last_ = then_;
    axis_last_ = axis_then_;
    to_last_ = to_then_;
    then_ = work.kind;
    axis_then_ = work.axis;
    to_then_ = work.to;

    for (std::uint32_t axis = 0; axis < rates_.axes; ++axis) {
      clock_pulse(axis, ask && axis == told.axis, down);
    }
    if (taken) {
      moved_ |= 1u << told.axis;
    }
    if (work.kind == Kind::position) {
      moved_ &= ~(1u << work.axis);
    }
    if (slot_ == 0) {
      first_ = false;
    }
    periods_.clock();
    if (told.base) {
      was_long_ = slot_ == rates_.short_clocks;
      slot_ = 0;
      served_ = served_ + 1 == rates_.axes ? 0 : served_ + 1;
    } else {
      ++slot_;
    }
    return told;
  }

  // How many whole base periods, at most `most`, begin here in which no axis steps and no pin changes? 0: none.
  [[nodiscard]] std::uint64_t quiet_periods(bool bank, std::uint64_t most) const noexcept {
    if (slot_ != 0 || first_ || moved_ != 0 || then_ != Kind::idle || last_ != Kind::idle) {
      return 0;
    }
    for (std::uint32_t axis = 0; axis < rates_.axes; ++axis) {
      const StepgenWay way(velocities_[bank ? 1 : 0][axis]);
      if (way.speed != 0) {
        const std::uint32_t at = memory_[phase][axis] & phase_mask();
        most = std::min<std::uint64_t>(most, way.periods_before_step(at, phase_mask()));
      }
      if (!pulses_[axis].is_quiet()) {
        return 0;
      }
    }
    return most;
  }
  // How many whole base periods, at most `most`, begin here that `play` can do? In these each step that is due is taken
  // at once. A bit of `halting` is an axis for which a step would change more than its position.
  [[nodiscard]] std::uint64_t playable_periods(bool bank, std::uint64_t most, std::uint32_t halting) const noexcept {
    const auto is_known = [](Kind kind) { return kind == Kind::idle || kind == Kind::position; };
    if (slot_ != 0 || first_ || moved_ != 0 || !is_known(then_) || !is_known(last_)) {
      return 0;
    }
    for (std::uint32_t axis = 0; axis < rates_.axes; ++axis) {
      const StepgenPulse& pulse = pulses_[axis];
      if (pulse.is_holding()) {
        return 0;
      }
      const StepgenWay way(velocities_[bank ? 1 : 0][axis]);
      if (way.speed == 0) {
        continue;
      }
      const std::uint64_t before = way.periods_before_step(memory_[phase][axis] & phase_mask(), phase_mask());
      if (before >= most) {
        continue;
      }
      const std::uint64_t least_clocks = (phase_mask() / way.speed) * std::uint64_t{rates_.short_clocks};
      const bool is_ready = periods_.clocks_of(before) + asks_at + axis >= pulse.clocks_to_ready();
      if (way.down == pulse.direction() || (halting >> axis & 1u) != 0 || least_clocks < pulse.whole_clocks() ||
          !is_ready) {
        most = before;
      }
    }
    return most;
  }
  // What the VHDL does in `periods` base periods, but for looks. Calls tell(pin, level, clocks): a pin changes in the
  // clock after so many, in the order of time for each axis. At most playable_periods.
  template <typename Tell>
  void play(bool bank, std::uint64_t periods, const Tell& tell) {
    finish_positions();
    const Clock before_last = periods_.clocks_of(periods - 1);
    const auto last_clocks = static_cast<std::uint32_t>(periods_.clocks_of(periods) - before_last);
    memory_[now][0] += static_cast<std::uint32_t>(rates_.short_clocks + (was_long_ ? 1 : 0) + before_last);
    was_long_ = last_clocks == rates_.short_clocks + 1;
    for (std::uint32_t axis = 0; axis < rates_.axes; ++axis) {
      StepgenTrain train{StepgenWay(velocities_[bank ? 1 : 0][axis]), phase_mask(), memory_[phase][axis]};
      train.play(pulses_[axis], periods_, periods, asks_at + axis,
                 [&tell, axis](bool level, Clock clocks) { tell(axis, level, clocks); });
      memory_[phase][axis] = train.at;
      pins_ = (pins_ & ~(1u << axis)) | (pulses_[axis].step() ? 1u << axis : 0u);
      count(axis, train, last_clocks);
    }
    periods_.skip(periods);
    served_ = static_cast<std::uint32_t>((served_ + periods) % rates_.axes);
  }
  void put_velocity(bool bank, std::uint32_t axis, std::uint32_t velocity) noexcept {
    velocities_[bank ? 0 : 1][axis] = velocity;
  }

 private:
  enum class Kind { idle, other, phase, position, latch_position, latch_stamp, shift };
  static constexpr std::uint32_t phases_at = 3;
  static constexpr std::uint32_t asks_at = phases_at + 2;  // axis 0 for a step

  struct Place {
    Part part = position;
    std::uint32_t axis = 0;
    bool operator==(const Place&) const = default;
    [[nodiscard]] bool is(Part other, std::uint32_t number) const noexcept { return part == other && axis == number; }
  };
  struct Operation {
    Kind kind = Kind::idle;
    std::uint32_t axis = 0;
    Place from, to;
    std::uint32_t term = 0;
  };

  // Nobody looks before the positions that are under way are stored.
  void finish_positions() noexcept {
    if (last_ == Kind::position) {
      memory_[to_last_.part][to_last_.axis] = sum_;
    }
    if (then_ == Kind::position) {
      memory_[to_then_.part][to_then_.axis] = word_ + term_;
    }
    last_ = then_ = Kind::idle;
  }

  // The position after the steps of a train. A step of the last period may still be under way.
  void count(std::uint32_t axis, const StepgenTrain& train, std::uint32_t last_clocks) noexcept {
    const std::uint32_t term = train.way.down ? ~0u : 1u;
    std::uint32_t& all = memory_[position][axis];
    const std::uint32_t slot = positions_at_ + axis;
    if (!train.ends_with_step || slot + 2 < last_clocks) {
      all += term * train.steps;
      return;
    }
    all += term * (train.steps - 1);
    if (slot + 1 == last_clocks) {
      then_ = Kind::position;
      axis_then_ = axis;
      to_then_ = {position, axis};
      word_ = all;
      term_ = term;
    } else {
      last_ = Kind::position;
      axis_last_ = axis;
      to_last_ = {position, axis};
      sum_ = all + term;
    }
  }

  void clock_pulse(std::uint32_t axis, bool asked, bool down) noexcept {
    StepgenPulse& pulse = pulses_[axis];
    if (!asked && pulse.is_resting()) {
      return;  // most clocks
    }
    pulse.clock(asked, down);
    const std::uint32_t step = 1u << axis;
    const std::uint32_t direction = step << rates_.axes;
    pins_ = (pins_ & ~(step | direction)) | (pulse.step() ? step : 0) | (pulse.direction() ? direction : 0);
  }

  [[nodiscard]] std::uint32_t phase_mask() const noexcept { return (1u << rates_.phase_bits()) - 1u; }
  [[nodiscard]] bool asks() const noexcept {
    return last_ == Kind::phase && (sum_ >> 31 != 0 || (sum_ >> rates_.phase_bits() & 1u) != 0);
  }
  [[nodiscard]] bool stores() const noexcept {
    return last_ != Kind::idle && !(asks() && !pulses_[axis_last_].takes(sum_ >> 31 != 0));
  }

  // The operation that begins in this slot.
  [[nodiscard]] Operation chosen(const Asked& asked) const noexcept {
    if (slot_ == 0) {
      std::uint32_t term = rates_.short_clocks + (was_long_ ? 1 : 0);
      if (first_) {
        term = static_cast<std::uint32_t>(rates_.clearing_clocks) + rates_.short_clocks + 1;
      }
      return {Kind::other, served_, {now, 0}, {now, 0}, term};
    }
    if (slot_ == 1 && (asked.catches >> served_ & 1u) != 0) {
      return {Kind::latch_stamp, served_, {now, 0}, {stamp, served_}, 0};
    }
    if (slot_ == 2 && then_ == Kind::latch_stamp) {
      return {Kind::latch_position, served_, {position, served_}, {latched, served_}, 0};
    }
    if (slot_ == 2 && asked.shift) {
      return {Kind::shift, asked.axis, {position, asked.axis}, {position, asked.axis}, shift_};
    }
    if (slot_ >= phases_at && slot_ < phases_at + rates_.axes) {
      const std::uint32_t axis = slot_ - phases_at;
      return {Kind::phase, axis, {phase, axis}, {phase, axis}, velocities_[asked.bank ? 1 : 0][axis]};
    }
    if (slot_ >= positions_at_ && slot_ < positions_at_ + rates_.axes) {
      const std::uint32_t axis = slot_ - positions_at_;
      if ((moved_ >> axis & 1u) != 0) {
        return {Kind::position, axis, {position, axis}, {position, axis}, pulses_[axis].direction() ? 1u : ~0u};
      }
    }
    return {};
  }

  StepgenRates rates_;
  StepgenPeriods periods_;
  std::uint32_t positions_at_ = 0;
  std::array<std::array<std::uint32_t, most_axes>, 5> memory_{};
  std::array<std::array<std::uint32_t, most_axes>, 2> velocities_{};
  std::uint32_t shift_ = 0;
  std::array<StepgenPulse, most_axes> pulses_;
  std::uint32_t pins_ = 0;
  std::uint32_t slot_ = 0, served_ = 0, moved_ = 0;
  bool first_ = true, was_long_ = false;
  Kind then_ = Kind::idle, last_ = Kind::idle;
  std::uint32_t axis_then_ = 0, axis_last_ = 0;
  Place to_then_, to_last_;
  std::uint32_t word_ = 0, term_ = 0, sum_ = 0;
};

}  // namespace unitylink::device
