// SPDX-License-Identifier: BSD-3-Clause
// The model of pid.vhd.
#include <algorithm>
#include <array>
#include <cstdlib>
#include <utility>

#include "device/component/component.hpp"
#include "device/component/signed_value.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

constexpr std::uint32_t gain_bits = 24;
constexpr Clock look_clocks = 1;    // from the tick to the check of the error
constexpr Clock work_clocks = 126;  // and to the output

class Pid final : public Component {
 public:
  explicit Pid(const ComponentConfiguration& from)
      : Component(from, "101111111111100", false),
        output_bits_(static_cast<std::uint32_t>(from.generic("output_wire_bits", 13))),
        filter_bits_(static_cast<std::uint32_t>(from.generic("filter_bits", 3))),
        most_((1u << (output_bits_ - 1)) - 1),
        safe_(from.generic("safe", 0)),
        ticks_(static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000)),
               static_cast<std::uint64_t>(from.generic("loop_hz", 20'000))),
        value_(safe_) {
    initial_word(limit, most_);
    word(output_word, static_cast<std::uint32_t>(value_), 0);
    initial_wire(0, {static_cast<std::uint32_t>(value_), true});
  }

 private:
  enum Register : std::uint32_t {
    control,
    status,
    target,
    target_velocity,
    target_acceleration,
    kp,
    ki,
    kd,
    kv,
    ka,
    limit,
    error_limit,
    apply,
    output_word,
    error_word
  };
  enum Input : std::uint32_t { feedback, target_wire, velocity_wire, acceleration_wire };

  [[nodiscard]] bool enable() const noexcept { return (write_word(control) & 1u) != 0; }
  [[nodiscard]] bool runs() const noexcept { return enable() && !is_tripped_; }
  [[nodiscard]] std::uint32_t gain(std::uint32_t address) const noexcept {
    return write_word(address) & ((1u << gain_bits) - 1);
  }
  [[nodiscard]] std::uint32_t limit_now() const noexcept { return std::min(write_word(limit) & 0x7FFFFFFFu, most_); }

  // What a wire or a register says of the target's motion. A wire that is valid comes first.
  [[nodiscard]] std::int64_t given(Input input, Register address) const noexcept {
    return wires_[input].valid ? limited(wrapped(wires_[input].value, 32), gain_bits)
                               : wrapped(write_word(address), gain_bits);
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min({tick_, look_, give_}); }

  void step(Clock edge) override {
    const bool ran = runs();
    bool trips = false;
    if (enable() && !enabled_before_) {
      is_tripped_ = false;
      lost_ = false;
    }
    if (ran && edge > 0 && ticks_.until(edge) != ticks_.until(edge - 1)) {
      sample(edge);
    }
    if (edge == look_) {
      const std::uint32_t most = gain(error_limit);
      trips = lost_ || (most != 0 && std::llabs(error_) > most);
      look_ = never;
    }
    if (edge == give_) {
      compute();
      give_ = never;
    }
    applies_ = applies_ || is_written(apply, edge);
    if (trips && ran) {
      is_tripped_ = true;
      event(0, edge);
    }
    enabled_before_ = enable();
    if (!ran || trips) {
      value_ = safe_;
      integral_ = filtered_ = 0;
      is_high_ = is_low_ = false;
      fresh_ = true;
      look_ = give_ = never;
    }
    tell(edge);
    tick_ = runs() ? ticks_.state_of(ticks_.until(edge) + 1) : never;
  }

  void sample(Clock edge) noexcept {
    const std::uint32_t now = wires_[feedback].value;
    const std::uint32_t goal = wires_[target_wire].valid ? wires_[target_wire].value : write_word(target);
    error_ = wrapped(goal - now, 32);
    moved_ = fresh_ ? 0 : wrapped(now - before_, 32);
    before_ = now;
    const bool takes = std::exchange(fresh_, false) || applies_;
    lost_ = !wires_[feedback].valid;
    limit_ = limit_now();
    velocity_ = given(velocity_wire, target_velocity);
    acceleration_ = given(acceleration_wire, target_acceleration);
    if (takes) {
      for (std::uint32_t number = 0; number < gains_.size(); ++number) {
        gains_[number] = gain(kp + number);
      }
      applies_ = false;
    }
    look_ = edge + look_clocks;
    give_ = edge + work_clocks;
    word(error_word, static_cast<std::uint32_t>(error_), edge);
  }

  void compute() noexcept {
    const std::int64_t error = limited(error_, gain_bits);
    filtered_ += (limited(moved_, gain_bits - 8) * 256 - filtered_) >> filter_bits_;
    const std::int64_t part = error * gains_[ki - kp];
    if (!(is_high_ && part > 0) && !(is_low_ && part < 0)) {
      integral_ = limited(integral_ + part, output_bits_ + gain_bits + 1);
    }
    const std::int64_t edge = std::int64_t{limit_} << gain_bits;
    integral_ = std::clamp(integral_, -edge, edge);
    const std::int64_t sum =
        error * gains_[0] - filtered_ * gains_[kd - kp] + velocity_ * gains_[kv - kp] + acceleration_ * gains_[ka - kp];
    const std::int64_t whole = (sum + (integral_ >> 8)) >> 16;
    is_high_ = whole >= limit_;
    is_low_ = !is_high_ && whole <= -std::int64_t{limit_};
    value_ = std::clamp(whole, -std::int64_t{limit_}, std::int64_t{limit_});
  }

  void tell(Clock edge) {
    word(status, (runs() ? 1u : 0u) | (is_high_ || is_low_ ? 2u : 0u) | (is_tripped_ ? 4u : 0u) | (lost_ ? 8u : 0u),
         edge);
    word(output_word, static_cast<std::uint32_t>(value_), edge);
    wire(0, {static_cast<std::uint32_t>(value_), true}, edge);
  }

  void stored(std::uint32_t address, Clock edge) override {
    const std::uint32_t value = write_word(address);
    switch (address) {
      case control:
        word(address, value & 1u, edge);
        tell(edge);
        break;
      case target: word(address, value, edge); break;
      case target_velocity:
      case target_acceleration: word(address, static_cast<std::uint32_t>(wrapped(value, gain_bits)), edge); break;
      case limit: word(address, limit_now(), edge); break;
      case apply: break;
      default: word(address, gain(address), edge);
    }
  }

  void wired(std::uint32_t input, const WireValue& value, Clock /*edge*/) override { wires_[input] = value; }

  std::uint32_t output_bits_;
  std::uint32_t filter_bits_;
  std::uint32_t most_;
  std::int64_t safe_;
  Tick ticks_;
  std::array<WireValue, 4> wires_{};
  std::array<std::int64_t, 5> gains_{};  // kp, ki, kd, kv, ka
  std::uint32_t before_ = 0;             // the feedback of the last period
  std::uint32_t limit_ = 0;
  std::int64_t error_ = 0;
  std::int64_t moved_ = 0;
  std::int64_t velocity_ = 0;
  std::int64_t acceleration_ = 0;
  std::int64_t filtered_ = 0;
  std::int64_t integral_ = 0;
  std::int64_t value_;
  bool enabled_before_ = false;
  bool is_tripped_ = false;
  bool lost_ = false;
  bool applies_ = false;
  bool fresh_ = true;
  bool is_high_ = false;
  bool is_low_ = false;
  Clock tick_ = never;
  Clock look_ = never;
  Clock give_ = never;
};

}  // namespace

std::unique_ptr<Component> make_pid(const ComponentConfiguration& from) { return std::make_unique<Pid>(from); }

}  // namespace unitylink::device
