// SPDX-License-Identifier: BSD-3-Clause
// The model of three_phase_pwm.vhd.
#include <algorithm>
#include <array>

#include "device/component/bridge_gates.hpp"
#include "device/component/component.hpp"
#include "device/component/period.hpp"

namespace unitylink::device {

namespace {

class ThreePhasePwm final : public Component {
 public:
  explicit ThreePhasePwm(const ComponentConfiguration& from)
      : Component(from, "101111", false),
        duty_bits_(static_cast<std::uint32_t>(from.generic("duty_bits", 13))),
        data_mask_(from.data_mask()),
        period_(from),
        gates_(from, phases) {
    word(dead, gates_.dead_used(), 0);
    for (const std::uint32_t number : {0u, 1u, 2u}) {
      load(number);
    }
  }

 private:
  enum Register : std::uint32_t { control, status, dead, duty };
  enum Event : std::uint32_t { sample, tripped };
  static constexpr std::uint32_t phases = 3;

  // The phases at which a high side is wanted: from `from` on, and before `turn - from`.
  [[nodiscard]] bool wanted(std::uint32_t number, std::uint64_t low) const noexcept {
    return low >= from_[number] && low < period_.turn() - from_[number];
  }

  // The duty of a phase is that of its wire, as long as it is valid.
  [[nodiscard]] std::uint32_t duty_now(std::uint32_t number) const noexcept {
    return wires_[number].valid ? wires_[number].value : write_word(duty + number);
  }
  [[nodiscard]] std::uint32_t valid() const noexcept {
    return (wires_[0].valid ? 1u : 0u) | (wires_[1].valid ? 2u : 0u) | (wires_[2].valid ? 4u : 0u);
  }

  void load(std::uint32_t number) noexcept {
    const std::uint32_t level = ((duty_now(number) ^ 1u << (duty_bits_ - 1)) & ((1u << duty_bits_) - 1u)) >> 1;
    const std::uint64_t below = ((std::uint64_t{1} << (duty_bits_ - 1)) - level) / 2;  // counts of the counter
    from_[number] = below << (period_.bits() + 1 - duty_bits_);
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min(next_, gates_.next()); }

  void step(Clock edge) override {
    const bool was_running = gates_.running();
    const Period::Phase now = period_.at(edge, was_running);
    const bool second = now.low >= period_.turn() / 2;
    const std::uint32_t asked = write_word(control);
    if (was_running && (((asked & 2u) != 0 && now.tick) || ((asked & 4u) != 0 && second && !half_))) {
      event(sample, edge);
    }
    half_ = second;
    const std::uint32_t sides = sides_;
    for (std::uint32_t number = 0; number < phases; ++number) {
      const std::uint32_t bit = 1u << number;
      sides_ = wanted(number, now.low) ? sides_ | bit : sides_ & ~bit;
      if (!was_running || now.tick) {
        load(number);
      }
    }
    const Period::Phase then = period_.step(edge, now, was_running);
    const bool enable = (asked & 1u) != 0;
    const bool ends = (valid_before_ & ~valid()) != 0;
    const bool drives = enable && !ends && (!lost_ || !enabled_before_);
    gates_.step(edge, drives, write_word(dead), (1u << phases) - 1u, sides);
    const bool wakes = enabled_before_ != enable || valid_before_ != valid();
    if (enable) {
      lost_ = ends || (lost_ && enabled_before_);
    }
    enabled_before_ = enable;
    valid_before_ = valid();
    tell(edge);
    plan(edge, then, wakes || sides != sides_);
  }

  void tell(Clock edge) {
    if (gates_.trip()) {
      event(tripped, edge);
    }
    word(status, gates_.status() | (lost_ ? 8u : 0u), edge);
    word(dead, gates_.dead_used(), edge);
    for (std::uint32_t number = 0; number < phases; ++number) {
      output(number, gates_.high(number), edge);
      output(phases + number, gates_.low(number), edge);
    }
  }

  // The next edge after `edge` that changes more than the phase.
  void plan(Clock edge, Period::Phase then, bool changes) noexcept {
    const std::uint64_t turn = period_.turn();
    std::uint64_t soonest = turn;
    changes = changes || then.tick || half_ != (then.low >= turn / 2);
    for (std::uint32_t number = 0; number < phases; ++number) {
      changes = changes || wanted(number, then.low) != ((sides_ >> number & 1u) != 0);
      for (const std::uint64_t change : {from_[number], turn - from_[number], turn / 2}) {
        soonest = change > then.low ? std::min(soonest, change) : soonest;
      }
    }
    next_ = never;
    if (changes) {
      next_ = edge + 1;
    } else if (gates_.running()) {
      next_ = edge + 1 + period_.until(then, soonest);
    }
  }

  void stored(std::uint32_t address, Clock edge) override {
    if (address == control) {
      word(address, write_word(control) & 7u, edge);
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
  Period period_;
  BridgeGates gates_;
  std::array<std::uint64_t, phases> from_{};
  std::array<WireValue, phases> wires_{};  // the duties from another component
  std::uint32_t valid_before_ = 0;
  bool enabled_before_ = false;
  bool lost_ = false;
  std::uint32_t sides_ = 0;
  bool half_ = false;
  Clock next_ = 0;
};

}  // namespace

std::unique_ptr<Component> make_three_phase_pwm(const ComponentConfiguration& from) {
  return std::make_unique<ThreePhasePwm>(from);
}

}  // namespace unitylink::device
