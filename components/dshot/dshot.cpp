// SPDX-License-Identifier: BSD-3-Clause
// The model of dshot.vhd.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

class Dshot final : public Component {
 public:
  explicit Dshot(const ComponentConfiguration& from)
      : Component(from, writable(channels_of(from)), false),
        channels_(channels_of(from)),
        bidirectional_(from.generic("bidirectional", 0) != 0),
        command_frames_(static_cast<std::uint32_t>(from.generic("command_frames", 10))),
        failures_most_(static_cast<std::uint32_t>(from.generic("failures_most", 10))),
        rounds_(clock_hz(from), static_cast<std::uint64_t>(from.generic("frame_hz", 1000))),
        filter_(channels_of(from), 1) {
    const std::uint64_t bit_hz = 1000u * static_cast<std::uint64_t>(from.generic("kbaud", 300));
    bit_ = (clock_hz(from) + bit_hz / 2) / bit_hz;
    one_ = (6 * bit_ + 4) / 8;
    zero_ = (3 * bit_ + 4) / 8;
    reply_ = (4 * clock_hz(from) / 5 + bit_hz / 2) / bit_hz;
    half_ = (reply_ + 1) / 2;
    const std::uint64_t clock_mhz = (clock_hz(from) + 999'999) / 1'000'000;
    listen_ = 50 * clock_mhz;
    heard_ = 40 * clock_mhz;
    for (std::uint32_t number = 0; number < channels_.size(); ++number) {
      tell(number, never);
      if (!outputs().empty()) {  // not in a look whether there is a model
        output(number, bidirectional_, never);
        output(drive_of(number), true, never);
      }
    }
    due_ = rounds_.state_of(1);
  }

 private:
  enum Register : std::uint32_t { throttle, command, speed, reply, stride };
  enum class State { idle, loading, coding, pulse, rest, listen, receive, divide, pause };
  static constexpr std::uint32_t throttle_most = 2000;
  static constexpr std::uint32_t first_value = 47;
  static constexpr std::uint32_t quarter_turns = 4'000'000;
  static constexpr Clock divide_clocks = 22;
  static constexpr std::uint32_t age_most = 127;

  struct Channel {
    std::uint32_t command = 0;
    std::uint32_t repeats = 0;  // frames of it that are still to come
    std::uint32_t age = age_most;
    std::uint32_t failures = 0;
    Clock changed = never;  // the edge that first sees another level
  };

  static std::uint64_t clock_hz(const ComponentConfiguration& from) {
    return static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000));
  }
  static std::uint32_t channels_of(const ComponentConfiguration& from) {
    return static_cast<std::uint32_t>(from.generic("channels", 4));
  }
  static std::string writable(std::uint32_t channels) {
    std::string found;
    for (std::uint32_t number = 0; number < channels; ++number) {
      found += "1100";
    }
    return found;
  }
  [[nodiscard]] std::uint32_t drive_of(std::uint32_t number) const noexcept {
    return static_cast<std::uint32_t>(channels_.size()) + number;
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min({due_, look_, filter_.next()}); }

  void step(Clock edge) override {
    look_ = never;
    const bool level = filter_.level(channel_);
    switch (state_) {
      case State::listen:
        if (!level && due_ - edge < heard_) {
          begin_reply(edge);
        } else if (edge == due_) {
          lose(edge);
        } else if (!level) {
          look_ = std::max(edge + 1, due_ - heard_ + 1);
        }
        break;
      case State::receive:
        if (channels_[channel_].changed == edge) {
          due_ = edge + half_;
        } else if (edge == due_) {
          due_ = edge + reply_;
          take(level, edge);
        }
        break;
      default:
        if (edge == due_) {
          turn(edge);
        }
    }
    for (std::uint32_t number = 0; number < channels_.size(); ++number) {
      if (is_written(stride * number + command, edge)) {
        const std::uint32_t asked = write_word(stride * number + command) & 0x3Fu;
        channels_[number].command = asked <= first_value ? asked : 0;
        channels_[number].repeats = command_frames_;
        word(stride * number + command, channels_[number].command, edge);
      }
    }
    if (bidirectional_) {
      hear(edge);
    }
  }

  void hear(Clock edge) {
    const std::uint32_t before = filter_.levels();
    if (!filter_.step(edge)) {
      return;
    }
    for (std::uint32_t number = 0; number < channels_.size(); ++number) {
      if (((before ^ filter_.levels()) >> number & 1u) != 0) {
        channels_[number].changed = edge + 1;
      }
    }
    look_ = edge + 1;
  }

  void turn(Clock edge) {
    switch (state_) {
      case State::idle:
        channel_ = 0;
        go(State::loading, edge, 1);
        break;
      case State::loading: load(edge); break;
      case State::coding:
        output(drive_of(channel_), true, edge);
        begin_bit(edge);
        break;
      case State::pulse:
        output(channel_, bidirectional_, edge);
        go(State::rest, edge, bit_ - ((frame_ & 0x8000u) != 0 ? one_ : zero_));
        break;
      case State::rest:
        frame_ = frame_ << 1 & 0xFFFFu;
        if (bits_-- != 0) {
          begin_bit(edge);
        } else if (bidirectional_) {
          output(drive_of(channel_), false, edge);
          go(State::listen, edge, listen_);
          if (!filter_.level(channel_)) {
            look_ = due_ - heard_ + 1;
          }
        } else {
          go(State::pause, edge, 4 * bit_);
        }
        break;
      case State::divide: judge(edge); break;
      default: end(edge);
    }
  }

  void load(Clock edge) {
    Channel& one = channels_[channel_];
    const std::uint32_t asked = write_word(stride * channel_ + throttle) & 0x7FFu;
    std::uint32_t value = 0;
    if (asked != 0) {
      value = (std::min(asked, throttle_most) + first_value) << 1;
      one.command = 0;
    } else if (one.command != 0) {
      value = one.command << 1 | 1u;
      if (--one.repeats == 0) {
        one.command = 0;
      }
    }
    word(stride * channel_ + command, one.command, edge);
    const std::uint32_t sum = (value >> 8 ^ value >> 4 ^ value) & 0xFu;
    frame_ = value << 4 | (bidirectional_ ? sum ^ 0xFu : sum);
    bits_ = 15;
    go(State::coding, edge, 1);
  }

  void begin_bit(Clock edge) {
    output(channel_, !bidirectional_, edge);
    go(State::pulse, edge, (frame_ & 0x8000u) != 0 ? one_ : zero_);
  }

  void begin_reply(Clock edge) noexcept {
    go(State::receive, edge, half_);
    bits_ = 0;
    sampled_ = false;
    code_ = 0;
  }

  // A bit of the reply. The first one is the start bit.
  void take(bool level, Clock edge) noexcept {
    code_ = code_ << 1 | (level != sampled_ ? 1u : 0u);
    sampled_ = level;
    if (bits_++ == 20) {
      go(State::divide, edge, divide_clocks);
    }
  }

  void judge(Clock edge) {
    // What is sent for a nibble, and what each of the 32 codes means; 16: it does not exist.
    static constexpr std::array<std::uint8_t, 32> nibbles{16, 16, 16, 16, 16, 16, 16, 16, 16, 9,  10,
                                                          11, 16, 13, 14, 15, 16, 16, 2,  3,  16, 5,
                                                          6,  7,  16, 0,  8,  1,  16, 4,  12, 16};
    bool wrong = scaled_;
    if (!scaled_) {
      std::uint32_t sum = 0;
      got_ = 0;
      for (const int place : {15, 10, 5, 0}) {
        const std::uint32_t nibble = nibbles[code_ >> place & 0x1Fu];
        wrong = wrong || nibble > 15;
        sum ^= nibble;
        got_ = got_ << 4 | (nibble & 0xFu);
      }
      if (wrong || (got_ >> 4 & 0x1FFu) == 0 || sum != 0xF) {
        lose(edge);
        return;
      }
      scaled_ = true;
      due_ = edge + 1 + (got_ >> 13);
      return;
    }
    scaled_ = false;
    const std::uint32_t turns = quarter_turns / (got_ >> 4 & 0x1FFu) >> (got_ >> 13);
    word(stride * channel_ + speed, got_ >> 4 == 0xFFF ? 0 : std::min(turns, 0xFFFFu), edge);
    channels_[channel_].age = 0;
    tell(channel_, edge);
    go(State::pause, edge, 4 * bit_);
  }

  void lose(Clock edge) {
    Channel& one = channels_[channel_];
    one.failures = (one.failures + 1) & 0xFFu;
    one.age = std::min(one.age + 1, age_most);
    tell(channel_, edge);
    event(1, edge);
    go(State::pause, edge, 4 * bit_);
  }

  void tell(std::uint32_t number, Clock edge) noexcept {
    const Channel& one = channels_[number];
    const std::uint32_t valid = one.age < failures_most_ ? 0x8000u : 0u;
    word(stride * number + reply, valid | one.age << 8 | one.failures, edge);
  }

  void end(Clock edge) {
    output(drive_of(channel_), true, edge);
    if (channel_ + 1 < channels_.size()) {
      ++channel_;
      go(State::loading, edge, 1);
      return;
    }
    event(0, edge);
    state_ = State::idle;
    due_ = rounds_.state_of(rounds_.until(edge) + 1);
  }

  void go(State state, Clock edge, Clock clocks) noexcept {
    state_ = state;
    due_ = edge + clocks;
  }

  void stored(std::uint32_t address, Clock edge) override {
    if (address % stride == throttle) {
      word(address, write_word(address) & 0x7FFu, edge);
    }
  }

  void driven(std::uint32_t pin, bool level, Clock edge) override {
    if (bidirectional_) {
      filter_.drive(pin, level, edge);
    }
  }

  std::vector<Channel> channels_;
  bool bidirectional_;
  std::uint32_t command_frames_;
  std::uint32_t failures_most_;
  Tick rounds_;
  InputFilter filter_;
  Clock bit_ = 1;
  Clock one_ = 1;
  Clock zero_ = 1;
  Clock reply_ = 1;
  Clock half_ = 1;
  Clock listen_ = 1;
  Clock heard_ = 1;

  State state_ = State::idle;
  std::uint32_t channel_ = 0;
  std::uint32_t frame_ = 0;
  std::uint32_t bits_ = 0;
  std::uint32_t code_ = 0;
  std::uint32_t got_ = 0;  // the reply
  bool sampled_ = false;
  bool scaled_ = false;  // the reply is right, and its quotient is being scaled
  Clock due_ = never;    // the edge at which this state ends by itself
  Clock look_ = never;   // the edge that sees another level
};

}  // namespace

std::unique_ptr<Component> make_dshot(const ComponentConfiguration& from) { return std::make_unique<Dshot>(from); }

}  // namespace unitylink::device
