// SPDX-License-Identifier: BSD-3-Clause
// The model of three_phase_pwm.vhd.
#include <algorithm>
#include <array>

#include "device/component/bridge_gates.hpp"
#include "device/component/component.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

constexpr std::uint32_t phases = 3;
constexpr Clock turn_clocks = 4;
constexpr Clock clearing_clocks = 6;  // two for the steps, four for the registers

// The counter of all phases, without a run of every clock. A period is a turn, and then steps of an accumulator.
class Counter {
 public:
  Counter(std::uint64_t clock_hz, std::uint64_t frequency_hz, std::uint32_t duty_bits)
      : bits_(bits_of(clock_hz / frequency_hz, duty_bits)),
        rate_(std::max<std::uint64_t>(1, clock_hz - turn_clocks * frequency_hz), (frequency_hz * 2) << bits_) {}

  [[nodiscard]] std::uint32_t bits() const noexcept { return bits_; }
  [[nodiscard]] std::uint64_t levels() const noexcept { return std::uint64_t{1} << bits_; }

  // A period begins in this state: the first one of a run, or a next one.
  void begin(Clock state) noexcept {
    begun_ = state;
    first_ = 0;
  }
  void begin_next() noexcept {
    const std::uint64_t one = std::uint64_t{1} << rate_.bits();
    const std::uint64_t sum = first_ + (wraps() - moves()) * rate_.increment();
    begun_ = wraps();
    first_ = sum % one;
  }

  [[nodiscard]] Clock begun() const noexcept { return begun_; }
  [[nodiscard]] Clock moves() const noexcept { return begun_ + turn_clocks; }  // the first state after the turn
  // The state in which the position, from 1 on, is reached.
  [[nodiscard]] Clock reaches(std::uint64_t position) const noexcept {
    const std::uint64_t sum = position << rate_.bits();
    const std::uint64_t left = sum > first_ ? sum - first_ : 0;
    return moves() + (left + rate_.increment() - 1) / rate_.increment();
  }
  [[nodiscard]] Clock middle() const noexcept { return reaches(levels()); }
  [[nodiscard]] Clock wraps() const noexcept { return reaches(2 * levels()); }

 private:
  static std::uint32_t bits_of(std::uint64_t clocks, std::uint32_t duty_bits) noexcept {
    std::uint32_t bits = 1;
    while (bits < duty_bits - 2 && (std::uint64_t{4} << bits) + turn_clocks <= clocks) {
      ++bits;
    }
    return bits;
  }

  std::uint32_t bits_;
  Tick rate_;
  Clock begun_ = 0;
  std::uint64_t first_ = 0;  // of the accumulator, after the turn
};

class ThreePhasePwm final : public Component {
 public:
  explicit ThreePhasePwm(const ComponentConfiguration& from)
      : Component(from, "101111", false),
        duty_bits_(static_cast<std::uint32_t>(from.generic("duty_bits", 13))),
        data_mask_(from.data_mask()),
        counter_(static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000)),
                 static_cast<std::uint64_t>(from.generic("frequency_hz", 20'000)), duty_bits_),
        gates_(from, phases) {
    word(dead, gates_.dead_used(), 0);
    never_high();
    wait_until(clearing_clocks);
  }

 private:
  enum Register : std::uint32_t { control, status, dead, duty };
  enum Event : std::uint32_t { sample, tripped };

  // A phase is high from a position on until the counter is there again. From 0 on: always.
  struct Pulse {
    std::uint64_t from = 0;
    Clock rises = never;
    Clock falls = never;
  };

  void never_high() noexcept { pulses_.fill({counter_.levels(), never, never}); }

  // The duty of a phase is that of its wire, as long as it is valid.
  [[nodiscard]] std::uint32_t duty_now(std::uint32_t number) const noexcept {
    return wires_[number].valid ? wires_[number].value : write_word(duty + number);
  }
  [[nodiscard]] std::uint32_t valid() const noexcept {
    return (wires_[0].valid ? 1u : 0u) | (wires_[1].valid ? 2u : 0u) | (wires_[2].valid ? 4u : 0u);
  }

  // What is seen at a position is seen at the gates a clock later.
  void load(std::uint32_t number) noexcept {
    const std::uint32_t from_zero = (duty_now(number) ^ 1u << (duty_bits_ - 1)) & ((1u << duty_bits_) - 1u);
    const std::uint64_t halves = from_zero >> (duty_bits_ - 1 - counter_.bits());
    Pulse& one = pulses_[number];
    one.from = counter_.levels() - (halves + 1) / 2;
    one.rises = one.from == 0 ? counter_.moves() : counter_.reaches(one.from) + 1;
    one.falls = one.from == 0 ? never : counter_.reaches(2 * counter_.levels() - one.from) + 1;
    if (one.from == counter_.levels()) {
      one.rises = never;
    }
  }

  [[nodiscard]] std::uint32_t sides(Clock state) const noexcept {
    std::uint32_t high = 0;
    for (std::uint32_t number = 0; number < phases && moves_; ++number) {
      const Pulse& one = pulses_[number];
      high |= one.rises <= state && state < one.falls ? 1u << number : 0u;
    }
    return high;
  }

  [[nodiscard]] bool begins(Clock state) const noexcept { return moves_ ? state == wraps_ : gates_.running(); }

  // Writes wait for a turn.
  Clock admitted(std::uint32_t /*address*/, bool writes, Clock edge) override {
    if (!writes) {
      return edge;
    }
    if (edge < loaded_) {
      return loaded_;
    }
    return begins(edge) && gates_.running() ? edge + turn_clocks : edge;
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min(next_, gates_.next()); }

  void step(Clock edge) override {
    const bool was_running = gates_.running();
    const std::uint32_t asked = write_word(control);
    const std::uint32_t wanted = sides(edge);
    if (moves_ && was_running && edge == counter_.middle() && (asked & 4u) != 0) {
      event(sample, edge);
    }
    if (begins(edge) && was_running) {
      turn(edge, asked);
    }
    const bool hold = edge > counter_.begun() && edge < loaded_;
    if (hold && was_running) {
      load(static_cast<std::uint32_t>(loaded_ - 1 - edge));
    }
    if (!was_running) {
      moves_ = false;
      never_high();
    }
    const bool enable = (asked & 1u) != 0;
    const bool ends = (valid_before_ & ~valid()) != 0;
    const bool drives = enable && !ends && (!lost_ || !enabled_before_);
    gates_.step(edge, drives, (1u << phases) - 1u, wanted, hold);
    const bool wakes = enabled_before_ != enable || valid_before_ != valid();
    if (enable) {
      lost_ = ends || (lost_ && enabled_before_);
    }
    enabled_before_ = enable;
    valid_before_ = valid();
    tell(edge);
    plan(edge, wakes);
  }

  // A period begins. The phases keep their sides until they have new duties.
  void turn(Clock edge, std::uint32_t asked) {
    if (moves_) {
      counter_.begin_next();
      if ((asked & 2u) != 0) {
        event(sample, edge);
      }
    } else {
      counter_.begin(edge);
      moves_ = true;
    }
    wraps_ = counter_.wraps();
    loaded_ = edge + turn_clocks;
  }

  void tell(Clock edge) {
    if (gates_.trip()) {
      event(tripped, edge);
    }
    word(status, gates_.status() | (lost_ ? 8u : 0u), edge);
    for (std::uint32_t number = 0; number < phases; ++number) {
      output(number, gates_.high(number), edge);
      output(phases + number, gates_.low(number), edge);
    }
  }

  // The next edge after `edge` that changes more than the counter.
  void plan(Clock edge, bool changes) noexcept {
    next_ = changes || edge + 1 < loaded_ || (gates_.running() && !moves_) ? edge + 1 : never;
    if (!moves_) {
      return;
    }
    const auto wait_for = [this, edge](Clock due) noexcept { next_ = due > edge ? std::min(next_, due) : next_; };
    wait_for(counter_.moves());
    wait_for(counter_.middle());
    wait_for(wraps_);
    for (const Pulse& one : pulses_) {
      wait_for(one.rises);
      wait_for(one.falls);
    }
  }

  void stored(std::uint32_t address, Clock edge) override {
    if (address == control) {
      word(address, write_word(control) & 7u, edge);
    } else if (address == dead) {
      gates_.take_dead(write_word(dead));
      word(dead, gates_.dead_used(), edge);
    } else if (address >= duty) {
      show_duty(address - duty, edge);
    }
  }

  void show_duty(std::uint32_t number, Clock edge) noexcept {
    const std::uint32_t sign = 1u << (duty_bits_ - 1);
    word(duty + number, (((duty_now(number) & (sign * 2u - 1u)) ^ sign) - sign) & data_mask_, edge);
  }

  void wired(std::uint32_t number, const WireValue& value, Clock edge) override {
    wires_[number] = value;
    show_duty(number, edge);
    next_ = std::min(next_, edge);
  }

  void driven(std::uint32_t /*fault*/, bool level, Clock /*edge*/) override { gates_.drive(level); }

  std::uint32_t duty_bits_;
  std::uint32_t data_mask_;
  Counter counter_;
  BridgeGates gates_;
  std::array<Pulse, phases> pulses_{};
  std::array<WireValue, phases> wires_{};  // the duties from another component
  std::uint32_t valid_before_ = 0;
  bool enabled_before_ = false;
  bool lost_ = false;
  bool moves_ = false;  // a run has begun
  Clock wraps_ = 0;     // the state in which the next period begins
  Clock loaded_ = 0;    // the first state after the last turn
  Clock next_ = 0;
};

}  // namespace

std::unique_ptr<Component> make_three_phase_pwm(const ComponentConfiguration& from) {
  return std::make_unique<ThreePhasePwm>(from);
}

}  // namespace unitylink::device
