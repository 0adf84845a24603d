// SPDX-License-Identifier: BSD-3-Clause
// The model of encoder_bank.vhd.
#include <algorithm>
#include <string>
#include <vector>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"

namespace unitylink::device {

namespace {

class EncoderBank final : public Component {
 public:
  explicit EncoderBank(const ComponentConfiguration& from)
      : Component(from, std::string(2 * channels_of(from), '1'), true),
        round_clocks_(round_of(channels_of(from))),
        sample_clocks_(in_rounds(
            InputFilter::lasting(from.generic("filter_ns", 0), from.generic("clock_hz", 50'000'000)), round_clocks_)),
        data_mask_(from.data_mask()),
        lines_(2 * channels_of(from), 1),
        channels_(channels_of(from)) {
    wait_until(round_clocks_ + 1);
  }

 private:
  enum Event : std::uint32_t { failed };
  enum Line : std::uint32_t { a = 1, b = 2 };
  static constexpr std::uint32_t faults_mask = 0xFFF;

  struct Channel {
    std::uint32_t sampled = 0;  // the lines, in the first clock of its turn
    std::uint32_t sample = 0;   // those of the last round with samples
    std::uint32_t levels = 0;   // that count
    std::uint32_t position = 0;
    std::uint32_t faults = 0;
  };

  struct Given {
    Clock taken = never;  // the edge that takes the word from the bus
    std::uint32_t address = 0;
    std::uint32_t value = 0;
  };

  [[nodiscard]] static std::uint32_t channels_of(const ComponentConfiguration& from) {
    return static_cast<std::uint32_t>(from.generic("channels", 8));
  }
  [[nodiscard]] static Clock round_of(std::uint32_t channels) noexcept {
    Clock round = 4;  // at least two channels, each with two clocks
    while (round < 2 * Clock{channels}) {
      round *= 2;
    }
    return round;
  }
  [[nodiscard]] static Clock in_rounds(Clock clocks, Clock round) noexcept {
    return (clocks + round - 1) / round * round;
  }
  // The first edge from `edge` on with this place in a span that repeats.
  [[nodiscard]] static Clock at_place(Clock place, Clock span, Clock edge) noexcept {
    return edge + (place + span - edge % span) % span;
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min(lines_.next(), soonest_); }

  void driven(std::uint32_t pin, bool level, Clock edge) override {
    // Both lines of a channel side by side: port a has the first pins, b those behind.
    lines_.drive(pin < channels_ ? 2 * pin : 2 * (pin - channels_) + 1, level, edge);
  }

  // A write waits for the second clock of its turn, and for the end of that round.
  Clock offered(std::uint32_t address, std::uint32_t value, Clock edge) override {
    const Clock taken = at_place(2 * Clock{address % channels_} + 1, round_clocks_, edge);
    given_ = {taken, address, value};
    soonest_ = std::min(soonest_, taken);
    return at_place(round_clocks_ - 1, round_clocks_, taken);
  }

  // Also a write that is answered by the edge that takes it.
  void stored(std::uint32_t, Clock) override { thaw(); }

  void step(Clock edge) override {
    lines_.step(edge);
    const auto turn = static_cast<std::uint32_t>(edge % round_clocks_ / 2);
    if (turn < channels_ && edge % 2 == 0) {
      channel(turn).sampled = levels_at(turn);
    } else if (turn < channels_) {
      decode(turn, edge);
    }
    if (edge % round_clocks_ == round_clocks_ - 1) {
      for (std::uint32_t number = 0; number < channels_; ++number) {
        word(number, channel(number).position & data_mask_, edge);
        word(channels_ + number, channel(number).faults & faults_mask, edge);
      }
      is_shown_ = true;
    }
    plan(edge + 1);
  }

  // The second clock of a turn.
  void decode(std::uint32_t number, Clock edge) {
    Channel& one = channel(number);
    if (given_.taken == edge) {
      (given_.address < channels_ ? one.position : one.faults) = given_.value;
      given_.taken = never;
      is_shown_ = false;
    }
    if (edge < round_clocks_) {
      one.sample = one.levels = one.sampled;
      return;
    }
    if (edge % sample_clocks_ >= round_clocks_) {
      return;
    }
    const std::uint32_t same = ~(one.sampled ^ one.sample);
    const std::uint32_t now = (one.sampled & same) | (one.levels & ~same);
    const std::uint32_t changed = (now ^ one.levels) & (a | b);
    if (changed == (a | b)) {
      ++one.faults;
      event(failed, edge);
    } else if (changed != 0) {
      one.position += ((now & a) != 0) != ((one.levels & b) != 0) ? 1u : ~0u;
    }
    is_shown_ = is_shown_ && changed == 0;
    one.sample = one.sampled;
    one.levels = now & (a | b);
  }

  // The next edge that does something: the samples of a channel whose lines do not rest, a write, or the end of a round
  // whose words are to be shown.
  void plan(Clock after) noexcept {
    soonest_ = given_.taken;
    if (!is_shown_) {
      soonest_ = std::min(soonest_, at_place(round_clocks_ - 1, round_clocks_, after));
    }
    for (std::uint32_t number = 0; number < channels_; ++number) {
      const Channel& one = channel(number);
      const std::uint32_t now = levels_at(number);
      if (now != one.levels || now != one.sample || one.sampled != now) {
        const Clock span = after < round_clocks_ ? round_clocks_ : sample_clocks_;
        soonest_ = std::min(
            {soonest_, at_place(2 * Clock{number}, span, after), at_place(2 * Clock{number} + 1, span, after)});
      }
    }
  }

  [[nodiscard]] std::uint32_t levels_at(std::uint32_t number) const noexcept {
    return (lines_.level(2 * number) ? a : 0u) | (lines_.level(2 * number + 1) ? b : 0u);
  }
  [[nodiscard]] Channel& channel(std::uint32_t number) noexcept { return states_[number]; }
  [[nodiscard]] const Channel& channel(std::uint32_t number) const noexcept { return states_[number]; }

  Clock round_clocks_;
  Clock sample_clocks_;  // from sample to sample
  std::uint32_t data_mask_;
  InputFilter lines_;  // a level shows a clock after the synchroniser has it, which is when a turn has sampled it
  std::uint32_t channels_;
  std::vector<Channel> states_ = std::vector<Channel>(channels_);
  Given given_;
  bool is_shown_ = true;  // the words are those of the channels
  Clock soonest_ = never;
};

}  // namespace

std::unique_ptr<Component> make_encoder_bank(const ComponentConfiguration& from) {
  return std::make_unique<EncoderBank>(from);
}

}  // namespace unitylink::device
