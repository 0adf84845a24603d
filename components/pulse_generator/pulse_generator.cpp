// SPDX-License-Identifier: BSD-3-Clause
// The model of pulse_generator.vhd.
#include <algorithm>
#include <numeric>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"

namespace unitylink::device {

namespace {

class PulseGenerator final : public Component {
 public:
  explicit PulseGenerator(const ComponentConfiguration& from)
      : Component(from, "111100", false),
        filter_(2, InputFilter::lasting(from.generic("filter_ns", 100), from.generic("clock_hz", 50'000'000))),
        frequency_most_(static_cast<std::uint32_t>(256 * from.generic("maximum_hz", 1'000'000))),
        half_second_(from.generic("clock_hz", 50'000'000) * 128),
        data_mask_(from.data_mask()),
        level_at_rest_(from.generic("active_level", 1) == 0) {
    const std::int64_t clock_hz = from.generic("clock_hz", 50'000'000);
    const std::int64_t time_hz = from.generic("time_hz", 1'000'000);
    const std::int64_t divisor = std::gcd(clock_hz, time_hz);
    tick_add_ = static_cast<std::uint64_t>(time_hz / divisor);
    tick_clocks_ = static_cast<std::uint64_t>(clock_hz / divisor);
    if (!outputs().empty()) {  // not in a look whether there is a model
      output(line, level_at_rest_, never);
    }
  }

 private:
  enum Register : std::uint32_t { frequency, width, burst, to_go, pulses, state };
  enum Event : std::uint32_t { begun, finished };
  enum Input : std::uint32_t { trigger, stop };
  enum Output : std::uint32_t { line };
  static constexpr std::uint32_t width_mask = 0xFFFFFF;
  static constexpr std::uint32_t burst_mask = 0xFFFF;

  // What a clock hands to the next one, but the sums, which run by themselves.
  struct Registers {
    std::uint32_t rate = 0;
    std::uint32_t to_go = 0;
    std::uint32_t pulses = 0;
    std::uint32_t skipped = 0;
    bool trigger_before = false;
    bool halted = false;
    bool rests = true;
    bool running = false;
    bool second = false;
    bool active = false;

    bool operator==(const Registers&) const = default;
  };

  [[nodiscard]] Clock next() const noexcept override {
    return std::min({filter_.next(), look_, half_, now_.active ? ends_ : never});
  }

  void step(Clock edge) override {
    const Registers before = now_;
    Registers after = now_;
    const bool pulled = filter_.level(stop);
    const bool stopped = pulled || before.halted;
    const std::uint32_t asked = write_word(frequency) & data_mask_;
    const bool bursts = (write_word(burst) & burst_mask) != 0;
    const bool half = before.running && edge >= half_;
    const bool due = half && !before.second;
    const bool wants = asked != 0 && !before.rests && !stopped && (!bursts || before.to_go != 0);
    const bool begins = due && wants && !before.active;
    const bool ends = before.active && (lasts_half_ ? half && before.second : edge == ends_);

    after.trigger_before = filter_.level(trigger);
    after.halted = pulled || (before.halted && !is_written(frequency, edge));
    if (stopped) {
      after.rate = 0;
      after.rests = true;
    } else if (asked != 0 || !before.active) {
      after.rate = asked;
      after.rests = asked == 0;
    }
    after.running = !before.rests && (wants || (before.running && !due) || before.active);
    after.second = before.running && before.second != half;
    after.active = (begins || (before.active && !ends)) && !stopped;
    if (begins) {
      begin(edge);
      after.pulses = (before.pulses + 1) & data_mask_;
    } else if (due && wants) {
      after.skipped = (before.skipped + 1) & 0xFFu;
    }
    if (ends && bursts && before.to_go == 0) {
      event(finished, edge);
    }
    after.to_go = left_of_burst(edge, begins, stopped);

    sum_up(edge, half, after.rate);
    now_ = after;
    half_ = half_from(edge + 1);
    const bool moved = filter_.step(edge);
    look_ = moved || !(now_ == before) ? edge + 1 : never;
    output(line, now_.active != level_at_rest_, edge);
    word(to_go, now_.to_go, edge);
    word(pulses, now_.pulses, edge);
    word(state, (now_.halted ? 0x200u : 0u) | (now_.running ? 0x100u : 0u) | now_.skipped, edge);
  }

  void begin(Clock edge) {
    const std::uint64_t ticks = write_word(width) & width_mask & data_mask_;
    lasts_half_ = ticks == 0;
    ends_ = lasts_half_ ? never : edge + (ticks * tick_clocks_ + tick_add_ - 1) / tick_add_;
    event(begun, edge);
  }

  [[nodiscard]] std::uint32_t left_of_burst(Clock edge, bool begins, bool stopped) const {
    const std::uint32_t asked = write_word(frequency) & data_mask_;
    const std::uint32_t of_burst = write_word(burst) & burst_mask;
    if (stopped || (is_written(frequency, edge) && asked == 0)) {
      return 0;
    }
    if (is_written(to_go, edge)) {
      return write_word(to_go) & data_mask_;
    }
    if (filter_.level(trigger) && !now_.trigger_before && asked != 0 && now_.to_go == 0) {
      return of_burst;
    }
    return now_.to_go - (begins && of_burst != 0 ? 1u : 0u);
  }

  // The sum of the frequencies since half a period began, in the next state. `from_` is the state of `sum_`.
  void sum_up(Clock edge, bool half, std::uint32_t rate) noexcept {
    if (!now_.running) {
      sum_ = 0;
    } else {
      sum_ += static_cast<std::int64_t>(edge - from_) * now_.rate;
      sum_ += half ? rate_less_ : now_.rate;
    }
    from_ = edge + 1;
    if (rate != 0) {
      rate_less_ = rate - half_second_;
    }
  }

  // The next state from `edge` on in which half a period is over.
  [[nodiscard]] Clock half_from(Clock edge) const noexcept {
    if (!now_.running || (sum_ < 0 && now_.rate == 0)) {
      return never;
    }
    return sum_ >= 0 ? edge : edge + static_cast<Clock>((-sum_ + now_.rate - 1) / now_.rate);
  }

  [[nodiscard]] bool refuses(std::uint32_t address, std::uint32_t value) const override {
    return address == frequency && (value & data_mask_) > frequency_most_;
  }

  void stored(std::uint32_t address, Clock edge) override {
    switch (address) {
      case frequency: word(address, write_word(address) & data_mask_, edge); break;
      case width: word(address, write_word(address) & width_mask & data_mask_, edge); break;
      case burst: word(address, write_word(address) & burst_mask, edge); break;
      default: break;
    }
    look_ = edge + 1;
  }

  void driven(std::uint32_t pin, bool level, Clock edge) override { filter_.drive(pin, level, edge); }

  InputFilter filter_;
  std::uint32_t frequency_most_;
  std::int64_t half_second_;
  std::uint32_t data_mask_;
  bool level_at_rest_;
  std::uint64_t tick_add_ = 1;
  std::uint64_t tick_clocks_ = 1;

  Registers now_;
  std::int64_t sum_ = 0;
  std::int64_t rate_less_ = 0;
  Clock from_ = 0;
  Clock half_ = never;
  bool lasts_half_ = false;
  Clock ends_ = never;  // the edge that ends the pulse
  Clock look_ = 0;      // an edge at which something may change
};

}  // namespace

std::unique_ptr<Component> make_pulse_generator(const ComponentConfiguration& from) {
  return std::make_unique<PulseGenerator>(from);
}

}  // namespace unitylink::device
