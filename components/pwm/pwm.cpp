// SPDX-License-Identifier: BSD-3-Clause
// The model of pwm.vhd.
#include <algorithm>

#include "device/component/component.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

class Pwm final : public Component {
 public:
  explicit Pwm(const ComponentConfiguration& from)
      : Component(from, std::string(2 + channels_of(from), '1'), false),
        longest_((1u << from.generic("counter_bits", 24)) - 1u),
        least_us_(static_cast<std::uint32_t>(from.generic("servo_minimum_us", 500))),
        most_us_(static_cast<std::uint32_t>(from.generic("servo_maximum_us", 2500))),
        microseconds_(static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000)), 1'000'000),
        widths_(channels_of(from)),
        high_(channels_of(from)) {}

 private:
  enum Register : std::uint32_t { control, period, first_width };
  static constexpr std::uint32_t servo_period_us = 20'000;

  static std::uint32_t channels_of(const ComponentConfiguration& from) {
    return static_cast<std::uint32_t>(from.generic("channels", 4));
  }

  [[nodiscard]] bool enabled() const noexcept { return (write_word(control) & 1u) != 0; }
  [[nodiscard]] bool servo() const noexcept { return (write_word(control) & 2u) != 0; }
  [[nodiscard]] std::uint32_t limited(std::uint32_t address) const noexcept {
    return std::min(write_word(address), longest_);
  }

  // The state in which the counter has counted `units` since the period began, and counts no further at its edge.
  [[nodiscard]] Clock counted(std::uint32_t units) const noexcept {
    return in_us_ ? microseconds_.state_of(microseconds_.until(begun_) + units) : begun_ + units;
  }
  [[nodiscard]] std::uint32_t count(Clock state) const noexcept {
    return static_cast<std::uint32_t>(in_us_ ? microseconds_.until(state - 1) - microseconds_.until(begun_)
                                             : state - 1 - begun_);
  }

  [[nodiscard]] Clock next() const noexcept override { return next_; }

  void step(Clock edge) override {
    const bool was_running = running_;
    for (std::uint32_t channel = 0; channel < widths_.size(); ++channel) {
      high_[channel] = was_running && enabled() && count(edge) < widths_[channel];
      output(channel, high_[channel] != 0, edge);
    }
    if (is_written(control, edge) || !enabled()) {
      running_ = false;
    } else if (!was_running || edge == counted(last_ + 1)) {
      begin(edge);
    }
    plan(edge);
  }

  void begin(Clock edge) {
    begun_ = edge;
    in_us_ = servo();
    running_ = servo() || limited(period) != 0;
    last_ = servo() ? servo_period_us - 1 : limited(period) - 1;
    for (std::uint32_t channel = 0; channel < widths_.size(); ++channel) {
      const std::uint32_t width = limited(first_width + channel);
      widths_[channel] = servo() && width != 0 ? std::clamp(width, least_us_, most_us_) : width;
    }
  }

  // The next edge after `edge` at which a pin or the period changes.
  void plan(Clock edge) noexcept {
    next_ = never;
    if (!running_) {
      const bool falls = std::find(high_.begin(), high_.end(), 1) != high_.end();
      const bool starts = enabled() && (servo() || limited(period) != 0);
      next_ = falls || starts ? edge + 1 : never;
      return;
    }
    next_ = counted(last_ + 1);
    for (std::uint32_t channel = 0; channel < widths_.size(); ++channel) {
      const Clock falls = counted(widths_[channel]) + 1;
      if (high_[channel] == 0 && count(edge + 1) < widths_[channel]) {
        next_ = edge + 1;
      } else if (high_[channel] != 0 && falls > edge) {
        next_ = std::min(next_, falls);
      }
    }
    next_ = std::max(next_, edge + 1);
  }

  void stored(std::uint32_t address, Clock edge) override {
    word(address, address == control ? write_word(control) & 3u : limited(address), edge);
  }

  std::uint32_t longest_;
  std::uint32_t least_us_;
  std::uint32_t most_us_;
  Tick microseconds_;
  std::vector<std::uint32_t> widths_;  // of this period
  std::vector<char> high_;             // of the pins
  bool running_ = false;
  bool in_us_ = false;      // the units of this period
  std::uint32_t last_ = 0;  // the count in the last unit of this period
  Clock begun_ = 0;         // the edge that began it
  Clock next_ = never;
};

}  // namespace

std::unique_ptr<Component> make_pwm(const ComponentConfiguration& from) { return std::make_unique<Pwm>(from); }

}  // namespace unitylink::device
