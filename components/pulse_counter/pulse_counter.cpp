// SPDX-License-Identifier: BSD-3-Clause
// The model of pulse_counter.vhd, with its pulse_counter_words.vhd.
#include <algorithm>
#include <array>
#include <optional>

#include "device/component/component.hpp"
#include "device/component/edge_velocity.hpp"
#include "device/component/input_filter.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

constexpr Clock clocks_of_a_round = 16;

class PulseCounter final : public Component {
 public:
  explicit PulseCounter(const ComponentConfiguration& from)
      : Component(from, from.generic("with_frequency", 0) != 0 ? "1100--0" : "1100", true),
        filter_(2, InputFilter::lasting(from.generic("filter_ns", 100), clock_hz(from))),
        tick_(static_cast<std::uint64_t>(clock_hz(from)),
              static_cast<std::uint64_t>(from.generic("time_hz", 1'000'000))),
        with_gate_(from.generic("with_gate", 0) != 0),
        with_frequency_(from.generic("with_frequency", 0) != 0),
        data_mask_(from.data_mask()),
        timeout_(longest(static_cast<std::uint64_t>(from.generic("timeout_ms", 500)) *
                         static_cast<std::uint64_t>(from.generic("time_hz", 1'000'000) / 1000))),
        speed_(from, from.generic("frequency_us", 10'000), 1000 * from.generic("timeout_ms", 500)),
        is_shut_(with_gate_) {
    wait_until(clocks_of_a_round + 1);
    initial_wire(count_wire, wire_of(0));
    if (with_frequency_) {
      initial_wire(frequency_wire, wire_of(0));
    }
  }

 private:
  enum Register : std::uint32_t { count, pause, stamp, period, age, nothing, frequency, words };
  enum Event : std::uint32_t { counted, stopped };
  enum Wire : std::uint32_t { count_wire, frequency_wire };
  enum Pin : std::uint32_t { line, gate };
  // The edges of a round that matter.
  static constexpr Clock takes_pulses = 2 * count;
  static constexpr Clock takes_pause = 2 * pause;
  static constexpr Clock pauses = takes_pause + 1;
  static constexpr Clock looks_at_age = 2 * age + 1;
  static constexpr Clock takes_frequency = 2 * frequency;
  static constexpr Clock shows = clocks_of_a_round - 1;

  [[nodiscard]] static std::int64_t clock_hz(const ComponentConfiguration& from) {
    return from.generic("clock_hz", 50'000'000);
  }
  // The age is compared by its highest bits.
  [[nodiscard]] static std::uint64_t longest(std::uint64_t ticks) noexcept {
    std::uint32_t coarse = 0;
    while (ticks >> coarse >= 128) {
      ++coarse;
    }
    return (((ticks - 1) >> coarse) + 1) << coarse;
  }
  // The first edge from `edge` on with this place in its round.
  [[nodiscard]] static Clock at_place(Clock place, Clock edge) noexcept {
    return edge + (place + clocks_of_a_round - edge % clocks_of_a_round) % clocks_of_a_round;
  }
  // A value in 32 bits, from those of a word.
  [[nodiscard]] WireValue wire_of(std::uint32_t value) const noexcept {
    const std::uint32_t sign = (data_mask_ >> 1) + 1;
    return {((value & data_mask_) ^ sign) - sign, true};
  }
  // Ticks before an edge.
  [[nodiscard]] std::uint64_t ticks_until(Clock edge) const noexcept { return edge == 0 ? 0 : tick_.until(edge - 1); }

  [[nodiscard]] Clock next() const noexcept override {
    return std::min({filter_.next(), compare_, turn_, steps_at_, with_frequency_ ? speed_.next() : never});
  }

  // A write waits for the turn of its word, and for the end of that round.
  Clock offered(std::uint32_t address, std::uint32_t value, Clock edge) override {
    given_ = {at_place(2 * address, edge), value};
    turn_ = std::min(turn_, given_.taken);
    return at_place(shows, given_.taken);
  }

  void step(Clock edge) override {
    const Clock place = edge % clocks_of_a_round;
    if (with_frequency_) {
      speed_.tick(edge);
      wire(frequency_wire, wire_of(static_cast<std::uint32_t>(speed_.value())), edge + 1);
    }
    if (place == takes_pulses) {
      take(edge);
      wire(count_wire, wire_of(live_[count]), edge + 1);  // it follows the turn by a clock
    } else if (place == looks_at_age) {
      look_at_age(edge);
    } else if (place == takes_frequency) {
      live_[frequency] = static_cast<std::uint32_t>(speed_.value());
    }
    look(edge);
    if (place == takes_pause && given_.taken == edge) {
      live_[pause] = given_.value;
    } else if (place == pauses) {
      paused_ = (live_[pause] & 1u) != 0;
      open_or_shut(edge);
    }
    if (place == shows) {
      for (const std::uint32_t address : {count, pause, stamp, period}) {
        word(address, live_[address] & data_mask_, edge);
      }
      if (with_frequency_) {
        word(frequency, live_[frequency], edge);
      }
    }
    plan(edge);
  }

  // Was it shut for an edge of the round of collecting that ends before this edge?
  [[nodiscard]] bool was_shut(Clock edge) const noexcept {
    return (is_shut_ && shut_from_ < edge) || (shut_until_ && *shut_until_ + clocks_of_a_round > edge);
  }

  // The turn of the count takes what was collected.
  void take(Clock edge) noexcept {
    live_[count] = (given_.taken == edge ? given_.value : live_[count]) + pulses_;
    stepped_ = pulses_ != 0;
    shut_ = was_shut(edge);
    const bool twice = pulses_ > 1;
    if (stepped_) {
      live_[stamp] = static_cast<std::uint32_t>(last_);
    }
    if (shut_ || (rests_ && !twice)) {
      live_[period] = 0;
    } else if (stepped_) {
      live_[period] = static_cast<std::uint32_t>(last_ - previous_);
    }
    pulses_ = 0;
  }

  void look_at_age(Clock edge) {
    if (shut_) {
      rests_ = true;
    } else if (stepped_) {
      rests_ = false;
      timeout_at_ = at_place(takes_pulses, tick_.state_of(last_ + timeout_) + 1) + looks_at_age;
    } else if (!rests_ && edge >= timeout_at_) {
      rests_ = true;
      event(stopped, edge);
    }
    stepped_ = false;  // a round in which nothing is taken has no turn
    shut_ = false;
  }

  void look(Clock edge) {
    const bool level = filter_.level(line);
    const bool counts = level && !before_ && !is_shut_ && edge >= clocks_of_a_round;
    if (with_frequency_) {
      const bool steps = edge == steps_at_;  // the encoder for the velocity follows by a clock
      if (steps) {
        speed_.moved(edge, true);
        steps_at_ = never;
      }
      speed_.stalls(edge, steps);
    }
    if (counts) {
      ++pulses_;
      previous_ = last_;
      last_ = ticks_until(edge);
      steps_at_ = with_frequency_ ? edge + 1 : never;
      event(counted, edge);
    }
    before_ = level;
    compare_ = filter_.step(edge) ? edge + 1 : never;
    open_or_shut(edge);
  }

  // What `edge` has changed acts from the next one on.
  void open_or_shut(Clock edge) noexcept {
    const bool shut = paused_ || (with_gate_ && !filter_.level(gate));
    if (shut && !is_shut_) {
      shut_from_ = edge + 1;
    } else if (!shut && is_shut_) {
      shut_until_ = edge;
    }
    is_shut_ = shut;
  }

  // The next edge with a turn that has something to do. Words that changed are shown at the end of their round.
  void plan(Clock edge) noexcept {
    turn_ = never;
    const Clock after = edge + 1;
    const Clock place = edge % clocks_of_a_round;
    if (place < shows && edge >= clocks_of_a_round) {
      turn_ = at_place(shows, after);
    }
    if (place < pauses) {
      turn_ = std::min(turn_, at_place(pauses, after));
    }
    if (place < looks_at_age) {
      turn_ = std::min(turn_, at_place(looks_at_age, after));
    }
    if (pulses_ != 0 || ((is_shut_ || was_shut(at_place(takes_pulses, after)) || rests_) && is_fresh())) {
      turn_ = std::min(turn_, at_place(takes_pulses, after));
    }
    if (!rests_ && timeout_at_ > edge) {
      turn_ = std::min(turn_, timeout_at_);
    }
    if (with_frequency_ && static_cast<std::uint32_t>(speed_.value()) != live_[frequency]) {
      turn_ = std::min(turn_, at_place(takes_frequency, after));
    }
    if (given_.taken != never && given_.taken > edge) {
      turn_ = std::min(turn_, given_.taken);
    }
  }

  // Is there a period that a pause or the timeout takes away?
  [[nodiscard]] bool is_fresh() const noexcept { return live_[period] != 0 || !rests_; }

  void driven(std::uint32_t pin, bool level, Clock edge) override {
    if (pin == line || with_gate_) {
      filter_.drive(pin, level, edge);
    }
  }

  struct Given {
    Clock taken = never;  // the edge that takes the word from the bus
    std::uint32_t value = 0;
  };

  InputFilter filter_;
  Tick tick_;
  bool with_gate_;
  bool with_frequency_;
  std::uint32_t data_mask_;
  std::uint64_t timeout_;  // in ticks
  EdgeVelocity speed_;
  bool is_shut_;
  std::array<std::uint32_t, words> live_{};
  Given given_;
  std::uint32_t pulses_ = 0;    // since the count had its turn
  std::uint64_t last_ = 0;      // the time of the last pulse, in ticks
  std::uint64_t previous_ = 0;  // that of the one before
  Clock shut_from_ = 0;
  std::optional<Clock> shut_until_;  // the last edge that was shut, before it opened
  Clock timeout_at_ = never;
  Clock steps_at_ = never;  // the edge at which the velocity sees a step
  Clock compare_ = never;   // the edge that compares the levels again
  Clock turn_ = never;      // the next edge that is the turn of something
  bool before_ = false;     // the level of the line a clock ago
  bool paused_ = false;
  bool rests_ = true;     // no pulse since the timeout
  bool stepped_ = false;  // what this round has taken
  bool shut_ = false;
};

}  // namespace

std::unique_ptr<Component> make_pulse_counter(const ComponentConfiguration& from) {
  return std::make_unique<PulseCounter>(from);
}

}  // namespace unitylink::device
