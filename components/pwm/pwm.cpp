// SPDX-License-Identifier: BSD-3-Clause
// The model of pwm.vhd.
#include <algorithm>
#include <vector>

#include "device/component/component.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

class Pwm final : public Component {
 public:
  explicit Pwm(const ComponentConfiguration& from)
      : Component(from, "1-" + std::string(channels_of(from), '1'), false),
        servo_(from.generic("servo", 0) != 0),
        least_us_(static_cast<std::uint32_t>(from.generic("servo_minimum_us", 500))),
        most_us_(static_cast<std::uint32_t>(from.generic("servo_maximum_us", 2500))),
        microseconds_(clock_hz(from), microsecond_hz),
        period_(servo_ ? 20'000 : clocks_of_period(from)),
        channels_(channels_of(from)) {
    std::uint32_t swept = 2;
    while (swept < first_width + channels_of(from)) {
      swept *= 2;
    }
    wait_until(swept);  // after a reset the words are cleared
  }

 private:
  enum Register : std::uint32_t { control, hole, first_width };
  static constexpr std::uint32_t word_mask = 0x1FFF;
  static constexpr std::uint32_t whole = 4096;
  static constexpr std::uint64_t microsecond_hz = 1'000'000;
  static constexpr Clock turn_clocks = 15;  // of a channel

  static std::uint64_t clock_hz(const ComponentConfiguration& from) {
    return static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000));
  }
  static std::uint64_t clocks_of_period(const ComponentConfiguration& from) {
    const auto frequency_hz = static_cast<std::uint64_t>(from.generic("frequency_hz", 20'000));
    return (clock_hz(from) + frequency_hz / 2) / frequency_hz;
  }
  static std::uint32_t channels_of(const ComponentConfiguration& from) {
    return static_cast<std::uint32_t>(from.generic("channels", 4));
  }

  // The units of time, which are clocks or µs: how many have come up to a state, and the state in which one comes.
  [[nodiscard]] std::uint64_t units_until(Clock state) const noexcept {
    return servo_ ? microseconds_.until(state) : state;
  }
  [[nodiscard]] Clock state_of(std::uint64_t unit) const noexcept {
    return servo_ ? microseconds_.state_of(unit) : unit;
  }

  // How long a pin is high, in units.
  [[nodiscard]] std::uint64_t length(std::uint32_t channel) const noexcept {
    const std::uint32_t asked = write_word(first_width + channel) & word_mask;
    if (servo_) {
      return asked == 0 ? 0 : std::clamp(asked, least_us_, most_us_);
    }
    return (std::min(asked, whole) * period_ + whole - 1) / whole;
  }

  [[nodiscard]] Clock next() const noexcept override { return next_; }

  void step(Clock edge) override {
    const bool enabled = (write_word(control) & 1u) != 0;
    if (!enabled) {
      stop(edge);
      return;
    }
    if (!running_) {
      begins_ = state_of(units_until(edge - 1) + 1);
      running_ = true;
    }
    if (turn_ < channels_.size() && edge == read_edge()) {
      take(turn_++);
    }
    if (edge == begins_) {
      begun_ = edge;
      begins_ = state_of(units_until(edge) + period_);
      turn_ = 0;
    }
    for (std::uint32_t number = 0; number < channels_.size(); ++number) {
      channels_[number].step(edge);
      output(number, channels_[number].high, edge);
    }
    plan();
  }

  void stop(Clock edge) {
    for (std::uint32_t number = 0; number < channels_.size(); ++number) {
      channels_[number] = {};
      output(number, false, edge);
    }
    running_ = false;
    turn_ = static_cast<std::uint32_t>(channels_.size());
    begins_ = never;
    next_ = never;
  }

  [[nodiscard]] Clock read_edge() const noexcept { return begun_ + 1 + turn_clocks * turn_; }

  // The turn of a channel begins. At its end, a pulse of the new length is loaded.
  void take(std::uint32_t number) noexcept {
    const std::uint64_t units = length(number);
    if (units != 0) {
      const std::uint64_t first = units_until(begun_ + turn_clocks * (number + 1)) + 1;
      channels_[number].rises = state_of(first);
      channels_[number].then_falls = state_of(first + units);
    }
  }

  void plan() noexcept {
    next_ = begins_;
    if (turn_ < channels_.size()) {
      next_ = std::min(next_, read_edge());
    }
    for (const Channel& one : channels_) {
      next_ = std::min({next_, one.rises, one.falls});
    }
  }

  void stored(std::uint32_t address, Clock edge) override {
    word(address, write_word(address) & (address == control ? 1u : word_mask), edge);
  }

  struct Channel {
    Clock rises = never;  // the edge at which the next pulse begins
    Clock then_falls = never;
    Clock falls = never;  // the edge at which this pulse ends
    bool high = false;

    void step(Clock edge) noexcept {
      if (edge == falls) {
        high = false;
        falls = never;
      }
      if (edge == rises) {
        high = true;
        falls = then_falls;
        rises = never;
      }
    }
  };

  bool servo_;
  std::uint32_t least_us_;
  std::uint32_t most_us_;
  Tick microseconds_;
  std::uint64_t period_;  // units
  std::vector<Channel> channels_;
  bool running_ = false;
  std::uint32_t turn_ = ~0u;  // the channel whose turn is next; behind the last: none
  Clock begun_ = 0;           // the edge that began this period
  Clock begins_ = never;      // the edge that begins the next one
  Clock next_ = never;
};

}  // namespace

std::unique_ptr<Component> make_pwm(const ComponentConfiguration& from) { return std::make_unique<Pwm>(from); }

}  // namespace unitylink::device
