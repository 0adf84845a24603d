// SPDX-License-Identifier: BSD-3-Clause
// The model of foc.vhd. A period is computed at its end, with all that its beginning saw.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "device/component/component.hpp"
#include "device/component/signed_value.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

class Foc final : public Component {
 public:
  explicit Foc(const ComponentConfiguration& from)
      : Component(from, "101111111000", false),
        pole_pairs_(from.generic("pole_pairs", 7)),
        angle_shift_(16 - from.generic("angle_bits", 14)),
        current_shift_(from.generic("current_shift", 2)),
        duty_bits_{from.generic("duty_0_wire_bits", 13), from.generic("duty_1_wire_bits", 13),
                   from.generic("duty_2_wire_bits", 13)},
        ticks_(static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000)),
               static_cast<std::uint64_t>(from.generic("loop_hz", 20'000))) {
    initial_word(limit, 75'674);
  }

 private:
  using Number = std::int64_t;
  static constexpr Clock work_clocks = 378;  // from the tick to the last edge of a period
  static constexpr std::uint32_t number_bits = 18;
  static constexpr Number inverse_root_3 = 37'837;
  static constexpr Number half_root_3 = 56'756;

  enum Register : std::uint32_t { control, status, target_d, target_q, kp, ki, limit, offset, apply, d, q, angle };
  enum Input : std::uint32_t { current_a, current_b, position, target_wire };

  struct Axis {
    Number integral = 0;
    Number voltage = 0;
    bool high = false;
  };

  // The table of foc_sine.vhd.
  static Number sine(std::uint32_t at) noexcept {
    const std::uint32_t place = (at >> 6 & 0xFFu) ^ ((at & 0x4000u) != 0 ? 0xFFu : 0u);
    const auto value = static_cast<Number>(std::lround(32767.0 * std::sin((place + 0.5) * std::numbers::pi / 512.0)));
    return (at & 0x8000u) != 0 ? -value : value;
  }
  static Number cosine(std::uint32_t at) noexcept { return sine((at + 0x4000u) & 0xFFFFu); }

  [[nodiscard]] bool enable() const noexcept { return (write_word(control) & 1u) != 0; }
  [[nodiscard]] bool runs() const noexcept { return enable() && !is_tripped_; }
  [[nodiscard]] bool inputs_valid() const noexcept {
    return wires_[current_a].valid && wires_[current_b].valid && wires_[position].valid;
  }
  [[nodiscard]] Number current_of(Input input, Number shift) const noexcept {
    return std::clamp<Number>(wrapped(wires_[input].value, 32) >> shift, -32'767, 32'767);
  }
  // The target of the wire, as long as it is valid.
  [[nodiscard]] Number target_now() const noexcept {
    return wires_[target_wire].valid ? current_of(target_wire, 0) : wrapped(write_word(target_q), 16);
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min({tick_, give_, look_}); }

  void step(Clock edge) override {
    const bool ran = runs();
    const bool valid = inputs_valid();
    const bool had_apply = applies_;
    applies_ = applies_ || is_written(apply, edge);
    if (ran && edge > 0 && ticks_.until(edge) != ticks_.until(edge - 1)) {
      sample(edge, had_apply);
    }
    if (edge == give_) {
      compute();
      give_ = never;
    }
    if (enable() && !enabled_before_) {
      is_tripped_ = false;
    }
    if (ran && !valid) {
      is_tripped_ = true;
      event(0, edge);
    }
    if (!ran || !valid) {
      axes_ = {Axis{0, axes_[0].voltage, false}, Axis{0, axes_[1].voltage, false}};
      is_limited_ = given_ = false;
      fresh_ = true;
      give_ = never;
    }
    const bool changes = enabled_before_ != enable() || runs() != ran;
    enabled_before_ = enable();
    tell(edge);
    look_ = changes ? edge + 1 : never;
    tick_ = runs() ? ticks_.state_of(ticks_.until(edge) + 1) : never;
  }

  void sample(Clock edge, bool had_apply) noexcept {
    a_ = current_of(current_a, current_shift_);
    b_ = current_of(current_b, current_shift_);
    targets_ = {wrapped(write_word(target_d), 16), target_now()};
    limit_ = write_word(limit) & 0x1FFFFu;
    const std::uint64_t turns =
        std::uint64_t{wires_[position].value & 0xFFFFu} * static_cast<std::uint64_t>(pole_pairs_);
    electrical_ = static_cast<std::uint32_t>((turns << angle_shift_) + write_word(offset)) & 0xFFFFu;
    if ((write_word(control) & 2u) != 0) {
      electrical_ = 0;
    }
    if (had_apply) {
      kp_ = write_word(kp) & 0x1FFFFu;
      ki_ = write_word(ki) & 0x1FFFFu;
      applies_ = is_written(apply, edge);
    }
    give_ = edge + work_clocks;
  }

  void compute() noexcept {
    const Number change = wrapped(electrical_ - before_, 16) * 8;
    speed_ = fresh_ ? 0 : speed_ + ((change - speed_) >> 3);
    before_ = electrical_;
    fresh_ = false;
    const Number beta = (a_ + 2 * b_) * inverse_root_3 >> 16;
    const Number s = sine(electrical_);
    const Number c = cosine(electrical_);
    const std::array<Number, 2> found{limited((a_ * c + beta * s) >> 15, number_bits),
                                      limited((beta * c - a_ * s) >> 15, number_bits)};
    control_axis(axes_[0], limited(targets_[0] - found[0], number_bits), limit_ - (limit_ >> 2));
    const Number half = axes_[0].voltage >> 1;
    control_axis(axes_[1], limited(targets_[1] - found[1], number_bits),
                 axes_[0].voltage < 0 ? limit_ + half : limit_ - half);
    is_limited_ = axes_[0].high || axes_[1].high;
    given_ = true;
    shown_ = {found[0], found[1], electrical_};
    modulate();
  }

  void control_axis(Axis& axis, Number error, Number most) const noexcept {
    const Number part = ki_ * error;
    // Not further to the side where the voltage is at its limit.
    const Number wide = axis.integral + (!axis.high || (part < 0) != (axis.voltage < 0) ? part : 0);
    axis.integral = wide >> 16 > most ? most << 16 : wide >> 16 < -most ? -(most << 16) : wide;
    const Number voltage = limited((kp_ * error >> 12) + (axis.integral >> 16), number_bits);
    axis.high = voltage >= most || voltage <= -most;
    axis.voltage = std::clamp(voltage, -most, most);
  }

  // The voltages of the phases, for the angle at which they will take effect.
  void modulate() noexcept {
    const auto at = static_cast<std::uint32_t>(electrical_ + (speed_ >> 3) + (speed_ >> 4)) & 0xFFFFu;
    const Number s = sine(at);
    const Number c = cosine(at);
    const Number alpha = limited((axes_[0].voltage * c - axes_[1].voltage * s) >> 15, number_bits);
    const Number beta = limited((axes_[0].voltage * s + axes_[1].voltage * c) >> 15, number_bits);
    const Number root = beta * half_root_3 >> 16;
    const std::array<Number, 3> phases{alpha, root - (alpha >> 1), -root - (alpha >> 1)};
    const auto [lowest, highest] = std::minmax_element(phases.begin(), phases.end());
    const Number middle = (*lowest + *highest) >> 1;
    for (std::size_t number = 0; number < phases.size(); ++number) {
      const Number most = (Number{1} << (duty_bits_[number] - 1)) - 1;
      duties_[number] =
          std::clamp(limited(phases[number] - middle, number_bits) >> (17 - duty_bits_[number]), -most, most);
    }
  }

  void tell(Clock edge) {
    word(status, (runs() ? 1u : 0u) | (is_limited_ ? 2u : 0u) | (is_tripped_ ? 4u : 0u), edge);
    for (std::uint32_t number = 0; number < shown_.size(); ++number) {
      word(d + number, static_cast<std::uint32_t>(shown_[number]), edge);
    }
    for (std::uint32_t number = 0; number < duties_.size(); ++number) {
      wire(number, {static_cast<std::uint32_t>(duties_[number]), given_ && runs()}, edge);
    }
  }

  void stored(std::uint32_t address, Clock edge) override {
    const std::uint32_t value = write_word(address);
    switch (address) {
      case control:
        word(address, value & 3u, edge);
        tell(edge);
        break;
      case target_q: word(address, static_cast<std::uint32_t>(target_now()), edge); break;
      case target_d: word(address, static_cast<std::uint32_t>(wrapped(value, 16)), edge); break;
      case offset: word(address, value & 0xFFFFu, edge); break;
      case apply: break;
      default: word(address, value & 0x1FFFFu, edge);
    }
  }

  void wired(std::uint32_t input, const WireValue& value, Clock edge) override {
    wires_[input] = value;
    word(target_q, static_cast<std::uint32_t>(target_now()), edge);
    look_ = std::min(look_, edge);
  }

  Number pole_pairs_;
  Number angle_shift_;
  Number current_shift_;
  std::array<Number, 3> duty_bits_;
  Tick ticks_;
  std::array<WireValue, 4> wires_{};
  // What a period saw at its beginning.
  Number a_ = 0;
  Number b_ = 0;
  std::array<Number, 2> targets_{};
  Number limit_ = 0;
  std::uint32_t electrical_ = 0;
  Number kp_ = 0;
  Number ki_ = 0;
  // What it keeps for the next one.
  std::uint32_t before_ = 0;
  Number speed_ = 0;
  std::array<Axis, 2> axes_{};
  std::array<Number, 3> shown_{};
  std::array<Number, 3> duties_{};
  bool enabled_before_ = false;
  bool is_tripped_ = false;
  bool is_limited_ = false;
  bool applies_ = false;
  bool given_ = false;
  bool fresh_ = true;
  Clock tick_ = never;
  Clock give_ = never;
  Clock look_ = never;
};

}  // namespace

std::unique_ptr<Component> make_foc(const ComponentConfiguration& from) { return std::make_unique<Foc>(from); }

}  // namespace unitylink::device
