// SPDX-License-Identifier: BSD-3-Clause
// The model of stepgen_motion.vhd: slots of one clock, each of them one operation on a word. Its names are those of the
// VHDL. `skip` is what the VHDL does in whole base periods without a step.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <numeric>

#include "stepgen_pulse.hpp"

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

  StepgenMotion(const ComponentConfiguration& from, const StepgenRates& rates) : rates_(rates) {
    for (StepgenPulse& pulse : pulses_) {
      pulse.configure(from);
    }
    std::uint32_t common = 0;
    while (common < rates.base_bits && (rates.clock_hz >> common) % 2 == 0) {
      ++common;
    }
    gain_ = std::int64_t{1} << (rates.base_bits - common);
    loss_ = rates.clock_hz >> common;
    owed_ = gain_ - loss_;
    positions_at_ = phases_at + std::max(rates.axes, 3u);
    pins_ = ((1u << rates.axes) - 1u) << rates.axes;  // all go up at first
  }

  bool operator==(const StepgenMotion&) const = default;

  // Does a base period begin, with no operation under way?
  [[nodiscard]] bool begins() const noexcept { return slot_ == 0 && then_ == Kind::idle && last_ == Kind::idle; }
  // The clocks after which the base periods have the same lengths again.
  [[nodiscard]] Clock cycle_clocks(std::uint32_t periods) const noexcept {
    return static_cast<Clock>(loss_) * (periods / std::gcd(static_cast<std::uint32_t>(gain_), periods));
  }
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
    told.base = owed_ >= 0;
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
    owed_ += told.base ? gain_ - loss_ : gain_;
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
      const auto velocity = static_cast<std::int32_t>(velocities_[bank ? 1 : 0][axis]);
      const std::uint64_t at = memory_[phase][axis] & phase_mask();
      if (velocity != 0) {
        const std::uint64_t way = velocity > 0 ? phase_mask() - at : at;
        most = std::min(most, way / static_cast<std::uint64_t>(std::abs(std::int64_t{velocity})));
      }
      if (!pulses_[axis].is_quiet()) {
        return 0;
      }
    }
    return most;
  }
  // The clocks of `periods` base periods from the first slot on.
  [[nodiscard]] Clock clocks_of(std::uint64_t periods) const noexcept {
    return static_cast<Clock>((loss_ * static_cast<std::int64_t>(periods - 1) - owed_ + gain_ - 1) / gain_) + 1;
  }
  void skip(bool bank, std::uint64_t periods) noexcept {
    const Clock clocks = clocks_of(periods);
    const Clock before_last = periods > 1 ? clocks_of(periods - 1) : 0;
    memory_[now][0] += static_cast<std::uint32_t>(rates_.short_clocks + (was_long_ ? 1 : 0) + before_last);
    was_long_ = clocks - before_last == rates_.short_clocks + 1;
    for (std::uint32_t axis = 0; axis < rates_.axes; ++axis) {
      std::uint32_t& at = memory_[phase][axis];
      at = (at & phase_mask()) + static_cast<std::uint32_t>(periods) * velocities_[bank ? 1 : 0][axis];
      pulses_[axis].skip(clocks);
    }
    owed_ += gain_ * static_cast<std::int64_t>(clocks) - loss_ * static_cast<std::int64_t>(periods);
    served_ = static_cast<std::uint32_t>((served_ + periods) % rates_.axes);
  }

 private:
  enum class Kind { idle, other, phase, position, latch_position, latch_stamp, shift };
  static constexpr std::uint32_t phases_at = 3;

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
  std::int64_t gain_ = 1, loss_ = 1, owed_ = 0;
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
