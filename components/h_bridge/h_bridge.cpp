// SPDX-License-Identifier: BSD-3-Clause
// The model of h_bridge.vhd.
#include <algorithm>
#include <array>

#include "device/component/bridge_gates.hpp"
#include "device/component/component.hpp"
#include "device/component/period.hpp"

namespace unitylink::device {

namespace {

class HBridge final : public Component {
 public:
  explicit HBridge(const ComponentConfiguration& from)
      : Component(from, "1011", false),
        duty_bits_(static_cast<std::uint32_t>(from.generic("duty_bits", 13))),
        form_(from.generic("form", 0)),
        data_mask_(from.data_mask()),
        period_(from),
        gates_(from, 2) {
    word(dead, gates_.dead_used(), 0);
    load();
  }

 private:
  enum Register : std::uint32_t { control, status, dead, duty };

  // The registers between the counter and the gates.
  struct Drive {
    std::uint32_t sides = 0;
    std::uint32_t driven = 0;
    bool forward = false;
    bool forward_before = false;

    friend bool operator==(const Drive& left, const Drive& right) noexcept {
      return left.sides == right.sides && left.driven == right.driven && left.forward == right.forward &&
             left.forward_before == right.forward_before;
    }
  };

  [[nodiscard]] bool on(std::uint64_t low) const noexcept { return low >= from_; }

  // The duty is that of the wire, as long as it is valid.
  [[nodiscard]] std::uint32_t duty_now() const noexcept { return wire_.valid ? wire_.value : write_word(duty); }

  void load() noexcept {
    const std::uint32_t sign = 1u << (duty_bits_ - 1);
    const std::uint32_t bits = duty_now() & (sign * 2u - 1u);
    back_ = (bits & sign) != 0;
    const std::uint32_t size = back_ ? sign * 2u - bits : bits;
    from_ = std::uint64_t{(sign - size) / 2} << (period_.bits() + 2 - duty_bits_);
  }

  [[nodiscard]] Drive drive_at(std::uint64_t low) const noexcept {
    const bool is_on = on(low);
    const bool coasts = (write_word(control) & 2u) != 0;
    return {is_on ? (back_ ? 2u : 1u) : 0u, is_on || !coasts ? 3u : 0u, !back_, drive_.forward};
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min(next_, gates_.next()); }

  void step(Clock edge) override {
    const bool was_running = gates_.running();
    const Period::Phase now = period_.at(edge, was_running);
    const Drive was = drive_;
    drive_ = drive_at(now.low);
    if (!was_running || now.tick) {
      load();
    }
    const Period::Phase then = period_.step(edge, now, was_running);
    gates_.step(edge, (write_word(control) & 1u) != 0, was.driven, was.sides);
    gates_.take_dead(write_word(dead));
    tell(edge);
    next_ = never;
    if (then.tick || !(drive_ == was) || !(drive_ == drive_at(then.low))) {
      next_ = edge + 1;
    } else if (gates_.running()) {
      next_ = edge + 1 + period_.until(then, on(then.low) ? period_.turn() : from_);
    }
  }

  void tell(Clock edge) {
    if (gates_.trip()) {
      event(0, edge);
    }
    word(status, gates_.status(), edge);
    word(dead, gates_.dead_used(), edge);
    const std::array<bool, 2> high{gates_.high(0), gates_.high(1)};
    const std::array<bool, 2> low{gates_.low(0), gates_.low(1)};
    std::array<bool, 4> pins{high[0], low[0], high[1], low[1]};
    if (form_ == 1) {
      const bool brakes = low[0] && low[1];
      pins = {high[0] || brakes, high[1] || brakes, false, false};
    } else if (form_ == 2) {
      pins = {drive_.forward_before, (high[0] && low[1]) || (high[1] && low[0]), false, false};
    }
    for (std::uint32_t number = 0; number < pins.size(); ++number) {
      output(number, pins[number], edge);
    }
  }

  void stored(std::uint32_t address, Clock edge) override {
    const std::uint32_t value = write_word(address);
    if (address == control) {
      word(address, value & 3u, edge);
    } else if (address == duty) {
      show_duty(edge);
    }
  }

  void show_duty(Clock edge) noexcept {
    const std::uint32_t sign = 1u << (duty_bits_ - 1);
    word(duty, (((duty_now() & (sign * 2u - 1u)) ^ sign) - sign) & data_mask_, edge);
  }

  void wired(std::uint32_t /*duty*/, const WireValue& value, Clock edge) override {
    wire_ = value;
    show_duty(edge);
    next_ = std::min(next_, edge);
  }

  void driven(std::uint32_t /*fault*/, bool level, Clock /*edge*/) override { gates_.drive(level); }

  std::uint32_t duty_bits_;
  std::int64_t form_;
  std::uint32_t data_mask_;
  Period period_;
  BridgeGates gates_;
  std::uint64_t from_ = 0;  // the phase from which the motor is driven
  bool back_ = false;
  Drive drive_;
  WireValue wire_;  // the duty from another component
  Clock next_ = 0;
};

}  // namespace

std::unique_ptr<Component> make_h_bridge(const ComponentConfiguration& from) { return std::make_unique<HBridge>(from); }

}  // namespace unitylink::device
