// SPDX-License-Identifier: BSD-3-Clause
// The model of stepgen_ramp.vhd, state by state. Its names are those of the VHDL.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include "stepgen_motion.hpp"

namespace unitylink::device {

class StepgenRamp {
 public:
  enum Word : std::uint32_t {
    control,
    target,
    speed,
    acceleration,
    velocity_target,
    velocity = 6,
    next = 7,
    shift = 10,
    goal = 12,
    reserve = 13,
    zero = 15
  };
  using Words = std::array<std::array<std::uint32_t, 16>, StepgenMotion::most_axes>;

  explicit StepgenRamp(const StepgenRates& rates)
      : axes_(rates.axes), phase_bits_(rates.phase_bits()), count_mask_((1u << (rates.base_bits - 14)) - 1u) {}

  bool operator==(const StepgenRamp&) const = default;

  [[nodiscard]] std::uint32_t axis() const noexcept { return number_; }
  [[nodiscard]] bool bank() const noexcept { return bank_; }
  [[nodiscard]] bool is_waiting() const noexcept { return state_ == State::waiting; }
  [[nodiscard]] bool is_near(std::uint32_t axis) const noexcept { return (near_ >> axis & 1u) != 0; }
  [[nodiscard]] std::uint32_t moving() const noexcept { return moving_; }
  [[nodiscard]] bool looks() const noexcept { return from_motion() && starts(); }
  [[nodiscard]] bool shifts() const noexcept { return state_ == State::await_shift; }
  // Does it use the memory of the parameters in this clock?
  [[nodiscard]] bool uses_words() const noexcept { return writes() || (starts() && !from_motion()); }

  void ask(StepgenMotion::Asked& asked) const noexcept {
    asked.put_velocity = state_ == State::write_next && is_settled();
    asked.put_shift = state_ == State::put_shift && is_settled();
    asked.data = sum_;
    asked.axis = number_;
    asked.bank = bank_;
    asked.look = looks();
    asked.look_axis = number_;
    asked.look_part = state_ == State::load_phase ? StepgenMotion::phase : StepgenMotion::position;
    asked.shift = shifts();
  }

  // `look_data` is of before this clock. A bit of `enabled` and `shifting` is an axis.
  void clock(Words& words, const StepgenMotion::Told& told, std::uint32_t look_data, std::uint32_t enabled,
             std::uint32_t shifting) noexcept {
    if (state_ == State::waiting && !executes_ && !adds_) {
      count(told.base);
      return;  // most clocks
    }
    const State state = state_;
    const bool executes = executes_;
    const bool settled = is_settled();
    const bool begins = starts();
    const std::uint32_t sum = sum_;
    const std::uint32_t number = number_;
    const Instruction now = instruction(sum);
    const bool negative = (sum >> 31) != 0;

    if (state == State::load_goal && !brakes_) {
      way_ = (way_ & 0xFFu) | std::uint64_t{sum} << 8;
    } else if (state == State::load_phase) {
      const std::uint32_t top = look_data >> (phase_bits_ - 8) & 0xFFu;
      way_ = (way_ & ~std::uint64_t{0xFF}) | (top ^ 0x7Fu);
    } else if (state == State::take_speed && executes) {
      way_ = (way_ << 1 | (way_down_ ? 1u : 0u)) & way_mask;
    }
    if (state == State::add_reserve && !executes) {
      speed_ = sum & speed_mask;
    } else if (state == State::take_speed && executes && speeds_) {
      speed_ = speed_ << 1 & speed_mask;
    }

    if (adds_) {
      const std::uint32_t before = then_.kept == Kept::none ? 0 : then_.kept == Kept::sum ? sum : sum << 1;
      sum_ = before + operand_ + (then_.carry ? 1u : 0u);
    }
    operand_ = then_.from_motion ? look_data : read_data_;
    operand_ = then_.minus ? ~operand_ : operand_;
    const std::uint32_t data = read_data_;
    if (begins && !now.from_motion) {
      read_data_ = words[number][now.word];
    }
    if (writes()) {
      words[number][state == State::write_goal ? goal : state == State::write_next ? following() : reserve] = sum;
    }
    then_ = now;
    executes_ = begins && (told.looked || !now.from_motion);
    adds_ = executes;
    if (!executes) {
      keep_first(state, negative, sum);
    }
    advance(state, now.after, executes, settled, negative, told.put);
    if (executes) {
      keep_second(state, data, look_data, sum, (enabled >> number & 1u) != 0);
    }
    end(state, number, (shifting >> number & 1u) != 0, told);
  }

  // Whole base periods pass while it waits. At most as many as before the tick.
  [[nodiscard]] std::uint32_t periods_to_tick() const noexcept { return count_mask_ - count_; }
  [[nodiscard]] std::uint32_t periods() const noexcept { return count_mask_ + 1; }  // of a ramp
  void skip(std::uint64_t periods) noexcept { count_ += static_cast<std::uint32_t>(periods); }

  // What the next ramp will write. It looks at no position, so the clock in which it does so makes no difference.
  struct Outcome {
    std::array<std::uint32_t, StepgenMotion::most_axes> goals{}, velocities{};
    bool arrived = false;
  };
  // Nothing: it must be run clock by clock, because a position or a phase counts, or because a flag changes.
  [[nodiscard]] std::optional<Outcome> outcome(const Words& words, const StepgenMotion& motion, std::uint32_t enabled,
                                               std::uint32_t shifting) const noexcept {
    Outcome result;
    result.arrived = arrived_;
    for (std::uint32_t axis = 0; axis < axes_; ++axis) {
      const auto& word = words[axis];
      const bool goes = (word[control] & 1u) != 0 && (enabled >> axis & 1u) != 0;
      if ((word[control] & 2u) == 0) {
        if (goes || word[velocity] != 0 || word[next] != 0) {
          return {};
        }
        result.arrived = word[target] == motion.word(axis, StepgenMotion::position);
      }
      result.goals[axis] = goes ? limited(word[velocity_target], word[speed]) : 0;
      // the tick makes the following one the current one
      result.velocities[axis] = approached(word[following()], result.goals[axis], word[acceleration]);
      const std::uint32_t bit = 1u << axis;
      const bool moves = result.velocities[axis] != 0 || (turning_ & bit) != 0;
      if ((shifting & bit) != 0 || moves != ((moving_ & bit) != 0) || result.arrived != is_near(axis)) {
        return {};
      }
    }
    return result;
  }
  // The tick, and all that the ramp does after it.
  void finish(const Outcome& made, Words& words, StepgenMotion& motion) noexcept {
    bank_ = !bank_;
    count_ = 0;
    arrived_ = made.arrived;
    for (std::uint32_t axis = 0; axis < axes_; ++axis) {
      const std::uint32_t bit = 1u << axis;
      words[axis][goal] = made.goals[axis];
      words[axis][following()] = made.velocities[axis];
      motion.put_velocity(bank_, axis, made.velocities[axis]);
      turning_ = made.velocities[axis] != 0 ? turning_ | bit : turning_ & ~bit;
    }
  }
  // The least number of ramps after the next tick in which no axis settles.
  [[nodiscard]] std::uint32_t unsettling(const Words& words) const noexcept {
    std::uint32_t least = most_unsettling;
    for (std::uint32_t axis = 0; axis < axes_; ++axis) {
      const auto& word = words[axis];
      const std::uint32_t from = word[following()];
      const std::uint32_t speed_now = from >> 31 != 0 ? 0u - from : from;
      const bool is_off = (word[control] & 1u) == 0 && word[velocity] == 0 && word[next] == 0;
      if ((moving_ >> axis & 1u) != 0) {
        least = std::min(least, speed_now == 0 ? 0 : (speed_now - 1) / std::max(1u, word[acceleration]));
      } else if (!is_off) {
        least = std::min(least, 2u);  // it moves in one, does not in the next, and settles in the third
      }
    }
    return least;
  }

 private:
  enum class State {
    waiting,
    load_control,
    load_phase,
    load_target,
    load_position,
    load_velocity_target,
    compare_speed,
    load_goal,
    write_goal,
    load_change,
    reach,
    load_velocity,
    change_velocity,
    write_next,
    load_speed,
    add_reserve,
    write_reserve,
    add_way,
    take_speed,
    judge,
    finish,
    load_shift,
    put_shift,
    await_shift
  };
  enum class Kept { none, sum, twice };
  struct Instruction {
    bool instructs = true;
    State after = State::waiting;
    Word word = zero;
    Kept kept = Kept::none;
    bool minus = false;
    bool carry = false;
    bool from_motion = false;
    bool operator==(const Instruction&) const = default;
  };
  static constexpr std::uint32_t most_unsettling = 1u << 14;  // a second
  static constexpr std::uint32_t speed_bits = 28;
  static constexpr std::uint32_t speed_mask = (1u << speed_bits) - 1u;
  static constexpr std::uint32_t way_bits = 40;
  static constexpr std::uint64_t way_mask = (std::uint64_t{1} << way_bits) - 1u;
  static constexpr std::uint32_t places = way_bits + 15;

  [[nodiscard]] bool from_motion() const noexcept {
    return state_ == State::load_phase || state_ == State::load_position;
  }
  [[nodiscard]] bool is_writing() const noexcept {
    return state_ == State::write_goal || state_ == State::write_next || state_ == State::write_reserve;
  }
  [[nodiscard]] bool writes() const noexcept { return is_writing() && is_settled(); }
  [[nodiscard]] bool is_settled() const noexcept {
    return !adds_ || state_ == State::add_way || state_ == State::take_speed;
  }
  [[nodiscard]] bool starts() const noexcept { return is_instruction() && !executes_ && is_settled(); }
  [[nodiscard]] bool is_instruction() const noexcept {
    switch (state_) {
      case State::waiting:
      case State::judge:
      case State::finish:
      case State::put_shift:
      case State::await_shift: return false;
      default: return !is_writing();
    }
  }
  [[nodiscard]] Word current() const noexcept { return bank_ ? next : velocity; }
  [[nodiscard]] Word following() const noexcept { return bank_ ? velocity : next; }
  [[nodiscard]] static std::uint32_t limited(std::uint32_t asked, std::uint32_t most) noexcept {
    const bool down = asked >> 31 != 0;
    const bool is_less = ((down ? asked + most : asked - most) >> 31 != 0) != down;
    return is_less ? asked : down ? 0u - most : most;
  }
  [[nodiscard]] static std::uint32_t approached(std::uint32_t from, std::uint32_t goal, std::uint32_t most) noexcept {
    const std::uint32_t change = goal - from;
    const bool slower = change >> 31 != 0;
    const bool is_less = ((slower ? change + most : change - most) >> 31 != 0) != slower;
    return is_less ? goal : slower ? from - most : from + most;
  }
  [[nodiscard]] static bool is_certain(std::uint32_t sum) noexcept { return sum >> 29 != 0 && sum >> 29 != 7; }

  [[nodiscard]] Instruction instruction(std::uint32_t sum) const noexcept {
    const bool negative = sum >> 31 != 0;
    Instruction now;
    now.instructs = is_instruction();
    now.from_motion = from_motion();
    switch (state_) {
      case State::load_control: return with(now, State::load_phase, control);
      case State::load_phase: return with(now, State::load_target, zero);
      case State::load_target: return with(now, State::load_position, target);
      case State::load_position:
        now = with(now, to_target_ ? State::load_goal : State::load_velocity_target, zero, Kept::sum, true);
        now.carry = !borrow_;
        return now;
      case State::load_velocity_target: return with(now, State::compare_speed, velocity_target);
      case State::compare_speed: return with(now, State::load_goal, speed, Kept::sum, !negative);
      case State::load_goal:
        if (!goes_ || brakes_) {
          return with(now, State::write_goal, zero);
        }
        if (!to_target_ && negative != goal_down_) {
          return with(now, State::write_goal, velocity_target);
        }
        return with(now, State::write_goal, speed, Kept::none, to_target_ ? negative : goal_down_);
      case State::load_change: return with(now, State::reach, current(), Kept::sum, true);
      case State::reach: return with(now, State::load_velocity, acceleration, Kept::sum, !negative);
      case State::load_velocity:
        return negative != slower_ ? with(now, State::write_next, goal) : with(now, State::change_velocity, current());
      case State::change_velocity: return with(now, State::write_next, acceleration, Kept::sum, slower_);
      case State::load_speed: return with(now, State::add_reserve, following(), Kept::none, way_down_);
      case State::add_reserve: return with(now, State::write_reserve, acceleration, Kept::sum);
      case State::add_way:
        return with(now, State::take_speed, (way_ >> (way_bits - 1) != 0) != way_down_ ? acceleration : zero,
                    place_ != places - 1 ? Kept::twice : Kept::none);
      case State::take_speed:
        return with(now, place_ == 0 ? State::judge : State::add_way,
                    speeds_ && speed_ >> (speed_bits - 1) != 0 ? reserve : zero, Kept::sum, true);
      case State::load_shift: return with(now, State::put_shift, shift);
      default: return now;
    }
  }
  static Instruction with(Instruction now, State after, Word word, Kept kept = Kept::none,
                          bool minus = false) noexcept {
    now.after = after;
    now.word = word;
    now.kept = kept;
    now.minus = now.carry = minus;
    return now;
  }

  // What the first clock of an instruction keeps of the result before.
  void keep_first(State state, bool negative, std::uint32_t sum) noexcept {
    if (state == State::compare_speed) {
      goal_down_ = negative;
    } else if (state == State::load_goal && !brakes_) {
      way_down_ = to_target_ ? negative : way_down_;
      arrived_ = to_target_ && sum == (borrow_ ? ~0u : 0u);
    } else if (state == State::reach) {
      slower_ = negative;
    }
  }

  void advance(State state, State after, bool executes, bool settled, bool negative, bool put) noexcept {
    switch (state) {
      case State::write_goal: state_ = settled ? State::load_change : state; break;
      case State::write_next:
        moves_ = sum_ != 0;
        if (put) {
          state_ = to_target_ && goes_ && !brakes_ && negative == way_down_ ? State::load_speed : State::finish;
        }
        break;
      case State::write_reserve:
        place_ = places - 1;
        speeds_ = false;
        state_ = settled ? State::add_way : state;
        break;
      case State::judge:
        if (settled) {
          brakes_ = brakes_ || negative;
          state_ = negative ? State::load_goal : State::finish;
        }
        break;
      case State::finish: {
        const std::uint32_t bit = 1u << number_;
        near_ = arrived_ ? near_ | bit : near_ & ~bit;
        moving_ = moves_ || (turning_ & bit) != 0 ? moving_ | bit : moving_ & ~bit;
        turning_ = moves_ ? turning_ | bit : turning_ & ~bit;
        state_ = State::load_shift;
        break;
      }
      case State::put_shift: state_ = put ? State::await_shift : state_; break;
      default:
        if (executes) {
          state_ = after;
        }
    }
  }

  // What the second clock keeps.
  void keep_second(State state, std::uint32_t data, std::uint32_t look_data, std::uint32_t sum, bool enabled) noexcept {
    if (state == State::load_control) {
      goes_ = (data & 1u) != 0 && enabled;
      to_target_ = (data & 2u) == 0;
      brakes_ = false;
    } else if (state == State::load_phase) {
      borrow_ = (look_data >> (phase_bits_ - 1) & 1u) != 0;
    } else if (state == State::take_speed) {
      speeds_ = speeds_ || place_ == speed_bits;
      place_ -= place_ > 0 ? 1 : 0;
    } else if (state == State::add_way && is_certain(sum) && place_ != places - 1) {
      adds_ = false;
      state_ = State::judge;
    }
  }

  void end(State state, std::uint32_t number, bool shifting, const StepgenMotion::Told& told) noexcept {
    if ((state == State::load_shift && !shifting) || (state == State::await_shift && told.shifted)) {
      executes_ = false;
      state_ = number + 1 == axes_ ? State::waiting : State::load_control;
      number_ += number + 1 == axes_ ? 0 : 1;
    }
    count(told.base);
  }

  // At each tick the ramp begins anew.
  void count(bool base) noexcept {
    if (base && count_ == count_mask_) {
      bank_ = !bank_;
      number_ = 0;
      executes_ = false;
      adds_ = false;
      state_ = State::load_control;
    }
    count_ = (count_ + (base ? 1 : 0)) & count_mask_;
  }

  std::uint32_t axes_, phase_bits_, count_mask_;
  State state_ = State::waiting;
  bool executes_ = false, adds_ = false;  // the second and the third clock of an instruction
  Instruction then_;
  std::uint32_t number_ = 0, count_ = 0;
  bool bank_ = false;
  std::uint32_t read_data_ = 0, operand_ = 0, sum_ = 0, speed_ = 0, place_ = 0;
  std::uint64_t way_ = 0;
  bool speeds_ = false, goes_ = false, to_target_ = false, brakes_ = false, borrow_ = false, arrived_ = false;
  bool moves_ = false, goal_down_ = false, way_down_ = false, slower_ = false;
  std::uint32_t near_ = 0, moving_ = 0, turning_ = 0;  // a bit for each axis
};

}  // namespace unitylink::device
