// SPDX-License-Identifier: BSD-3-Clause
// The model of absolute_encoder.vhd.
#include <algorithm>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

namespace {

class AbsoluteEncoder final : public Component {
 public:
  explicit AbsoluteEncoder(const ComponentConfiguration& from)
      : Component(from, "1000001", false),
        kind_(static_cast<Kind>(from.generic("kind", 0))),
        bits_(static_cast<std::uint32_t>(from.generic("bits", 13))),
        tail_(kind_ == ssi    ? static_cast<std::uint32_t>(from.generic("tail_bits", 0))
              : kind_ == biss ? 8u
                              : 0u),
        frame_bits_(kind_ == ssi    ? static_cast<std::uint32_t>(from.generic("lead_bits", 0)) + bits_ + tail_
                    : kind_ == biss ? bits_ + 9
                                    : 16),
        gray_(from.generic("gray", 1) != 0),
        zero_(static_cast<std::uint32_t>(from.generic("zero", 0))),
        failures_most_(static_cast<std::uint32_t>(from.generic("failures_most", 3))),
        filter_(1, 1),
        rate_(clock_of(from), static_cast<std::uint64_t>(from.generic("sample_hz", 10'000))),
        us_(clock_of(from), 1'000'000) {
    const std::int64_t clock_hz = from.generic("clock_hz", 50'000'000);
    const std::int64_t khz = (clock_hz + 999) / 1000;
    half_ =
        static_cast<Clock>(std::max<std::int64_t>(3, (clock_hz - 1) / (2 * from.generic("sclk_hz", 1'000'000)) + 1));
    const std::int64_t select = (400 * khz + 999'999) / 1'000'000;
    const std::int64_t pause = (from.generic("pause_us", 25) * khz + 999) / 1000;
    pause_ = static_cast<Clock>(std::max<std::int64_t>(4, kind_ == spi ? select : pause));
    answer_ = static_cast<Clock>((40 * khz + 999) / 1000);
    turn_ = pause_ - 1;
    initial_word(control, 1);
    word(age, longest_age, 0);
    if (!outputs().empty()) {  // state 0 has them
      line(sclk, rest(), never);
      line(select_n, true, never);
    }
  }

 private:
  static constexpr Clock latency = 3;  // of the input
  static constexpr std::uint32_t longest_age = (1u << 20) - 1;
  static constexpr std::uint32_t angle_command = 0xFFFF;
  static constexpr std::uint32_t field_command = 0x7FFD;
  static constexpr std::uint32_t clear_command = 0x4001;

  enum Kind : std::uint32_t { ssi, biss, spi };
  enum Register : std::uint32_t { control, status, failures, age, stamp, raw, position };
  enum Output : std::uint32_t { sclk, select_n, mosi };
  enum Event : std::uint32_t { sampled, failed };
  enum Reason : std::uint32_t { fine, no_answer, wrong_check, device_error };
  enum class State { resting, selecting, clocking, ending, deselected, judging };
  enum class Stage { acknowledge, start, data };

  [[nodiscard]] static std::uint64_t clock_of(const ComponentConfiguration& from) {
    return static_cast<std::uint64_t>(from.generic("clock_hz", 50'000'000));
  }
  [[nodiscard]] bool rest() const noexcept { return kind_ != spi; }
  [[nodiscard]] bool enable() const noexcept { return (write_word(control) & 1u) != 0; }
  [[nodiscard]] std::uint32_t mask() const noexcept { return bits_ >= 32 ? 0xFFFFFFFFu : (1u << bits_) - 1u; }
  // A number of `bits` bits with a sign.
  [[nodiscard]] std::uint32_t extended(std::uint32_t value) const noexcept {
    const std::uint32_t sign = 1u << (bits_ - 1);
    return ((value & mask()) ^ sign) - sign;
  }
  // A device may have fewer lines.
  void line(std::uint32_t pin, bool level, Clock edge) {
    if (pin < outputs().size()) {
      output(pin, level, edge);
    }
  }

  [[nodiscard]] Clock next() const noexcept override { return std::min({next_of_state(), filter_.next(), looks_}); }

  [[nodiscard]] Clock next_of_state() const noexcept {
    switch (state_) {
      case State::resting:
        if (!enable()) {
          return valid_ ? 0 : never;
        }
        return std::max(turn_, rate_.state_of(rate_.until(cleared_) + 1) + 1);
      case State::clocking: return std::min({turn_, take_, patience_});
      case State::judging: return 0;
      default: return turn_;
    }
  }

  void step(Clock edge) override {
    const bool turns = edge >= turn_;
    const bool level = filter_.level(0);
    takes_ = false;
    looks_ = never;
    if (is_written(position, edge)) {
      position_ = write_word(position);
    }
    switch (state_) {
      case State::resting: rest_at(edge, turns, level); break;
      case State::selecting:
        if (turns) {
          rise(edge);
          wait(edge, half_);
          state_ = State::clocking;
        }
        break;
      case State::clocking: clock(edge, turns, level); break;
      case State::ending:
        if (turns) {
          end(edge, level);
        }
        break;
      case State::deselected:
        if (turns) {
          deselected(edge);
        }
        break;
      case State::judging: judge(edge); break;
    }
    if (takes_) {
      take(level);
    }
    looks_ = filter_.step(edge) ? edge + 1 : looks_;
    tell(edge);
  }

  void rest_at(Clock edge, bool turns, bool level) {
    if (!enable()) {
      valid_ = false;
    } else if (turns && rate_.until(edge - 1) > rate_.until(cleared_)) {
      cleared_ = began_ = edge;
      reason_ = fine;
      second_ = primed_ = false;
      begin_frame();
      if (kind_ == spi) {
        select(angle_command, edge);
      } else if (!level) {
        reason_ = no_answer;
        state_ = State::judging;
      } else {
        clock_ = false;
        line(sclk, false, edge);
        wait(edge, half_);
        stage_ = Stage::acknowledge;
        take_ = never;
        patience_ = kind_ == biss ? edge + answer_ : never;
        state_ = State::clocking;
      }
    }
  }

  void select(std::uint32_t command, Clock edge) {
    command_ = command;
    line(select_n, false, edge);
    wait(edge, pause_);
    patience_ = take_ = never;
    state_ = State::selecting;
  }

  void begin_frame() noexcept {
    left_ = frame_bits_ - 1;
    shift_ = crc_ = 0;
    parity_ = error_ = done_ = false;
  }

  // The clock rises and the next bit of the command is put out.
  void rise(Clock edge) {
    clock_ = primed_ = true;
    line(sclk, true, edge);
    line(mosi, kind_ == spi && (command_ & 0x8000u) != 0, edge);
    command_ <<= 1;
  }

  void clock(Clock edge, bool turns, bool level) {
    bool finished = done_;
    if (kind_ == biss) {
      const Stage before = stage_;
      if (stage_ == Stage::acknowledge && !level) {
        stage_ = Stage::start;
      } else if (stage_ == Stage::start && level) {
        stage_ = Stage::data;
        take_ = edge + 3 * half_;
      } else if (stage_ == Stage::data && edge >= take_) {
        takes_ = true;
        take_ = edge + 2 * half_;
      }
      if (before != Stage::data && edge >= patience_) {
        fail(no_answer);
        done_ = true;
        patience_ = never;
      } else if (stage_ == Stage::data) {
        patience_ = never;
      }
    } else if (edge == take_) {
      takes_ = true;
      take_ = never;
    }
    if (takes_ && left_ == 0) {
      finished = true;
      take_ = never;
    }
    if (turns) {
      turn(edge, finished);
    }
    if (takes_) {
      done_ = finished;
    }
  }

  void turn(Clock edge, bool finished) {
    const bool was_high = clock_;
    wait(edge, half_);
    if (finished && (kind_ == biss || !was_high)) {
      clock_ = rest();
      primed_ = true;
      line(sclk, rest(), edge);
      line(mosi, false, edge);
      wait(edge, kind_ == ssi ? 2 * half_ : kind_ == biss ? 1 : pause_);
      state_ = State::ending;
    } else if (was_high) {
      clock_ = false;
      line(sclk, false, edge);
      if (kind_ != biss && primed_ && !finished) {
        take_ = edge + latency;
      }
    } else {
      rise(edge);
    }
  }

  void end(Clock edge, bool level) {
    state_ = State::judging;
    if (kind_ == ssi && level) {
      fail(no_answer);
    } else if (kind_ == biss && crc_ != 0) {
      fail(wrong_check);
    } else if (kind_ == biss && error_) {
      fail(device_error);
    } else if (kind_ == spi) {
      line(select_n, true, edge);
      wait(edge, pause_);
      state_ = State::deselected;
      if (second_ || renews_ == 0) {
        if (parity_) {
          fail(wrong_check);
        } else if ((!second_ && shift_ == 0) || (error_ && shift_ == mask())) {
          fail(no_answer);
        } else if (error_) {
          fail(device_error);
        }
      }
      if (!second_) {
        began_ = edge;
      }
    }
  }

  void deselected(Clock edge) {
    if (second_) {
      state_ = State::judging;
      return;
    }
    second_ = true;
    primed_ = false;
    begin_frame();
    select(renews_ == 2 ? clear_command : field_command, edge);
  }

  void judge(Clock edge) {
    if (reason_ == fine && kind_ == spi && renews_ != 0) {
      --renews_;
    } else if (reason_ != fine) {
      failure_ = reason_;
      failures_now_ = (failures_now_ + 1) & 0xFFFFu;
      renews_ = 2;
      if (++in_a_row_ == failures_most_) {
        in_a_row_ = 0;
        valid_ = false;
      }
      event(failed, edge);
    } else if (is_held(edge)) {
      return;
    } else {
      position_ = begun_ ? position_ + extended(shift_ - raw_) : extended(shift_ - zero_);
      raw_ = shift_;
      valid_ = begun_ = true;
      in_a_row_ = 0;
      failure_ = fine;
      warning_ = warns_;
      stamp_ = static_cast<std::uint32_t>(began_);
      fresh_since_ = us_.until(edge);
      event(sampled, edge);
    }
    state_ = State::resting;
    wait(edge, pause_);
  }

  void take(bool level) noexcept {
    const std::uint32_t left = left_;
    left_ = std::max(left, 1u) - 1;
    if (left >= tail_ && left < tail_ + bits_) {
      shift_ = (shift_ << 1 | static_cast<std::uint32_t>(level != (gray_ && (shift_ & 1u) != 0))) & mask();
    }
    if (kind_ == biss) {
      if (left <= bits_ + 7) {
        const std::uint32_t in = static_cast<std::uint32_t>(level != (left < 6));
        crc_ = ((crc_ << 1 | in) & 0x3Fu) ^ ((crc_ & 0x20u) != 0 ? 3u : 0u);
      }
      error_ = left == 7 ? !level : error_;
      warns_ = left == 6 ? !level : warns_;
    } else if (kind_ == spi) {
      parity_ = parity_ != level;
      error_ = left == 14 ? level : error_;
    }
  }

  void fail(Reason why) noexcept {
    if (reason_ == fine) {
      reason_ = why;
    }
  }

  // The timer is over so many clocks behind this edge.
  void wait(Clock edge, Clock clocks) noexcept { turn_ = edge + clocks; }

  void tell(Clock edge) {
    word(status, (valid_ ? 1u : 0u) | (warning_ ? 2u : 0u) | failure_ << 4, edge);
    word(failures, failures_now_, edge);
    word(stamp, stamp_, edge);
    word(raw, raw_, edge);
    word(position, position_, edge);
    wire(0, {position_, valid_}, edge);
  }

  void stored(std::uint32_t address, Clock edge) override {
    if (address == control) {
      word(control, write_word(control) & 1u, edge);
    }
  }

  void look(std::uint32_t address, Clock state) override {
    if (address == age && state > 0 && begun_) {
      const std::uint64_t passed = us_.until(state - 1) - fresh_since_;
      word(age, static_cast<std::uint32_t>(std::min<std::uint64_t>(passed, longest_age)), state - 1);
    }
  }

  void driven(std::uint32_t /*miso*/, bool level, Clock edge) override { filter_.drive(0, level, edge); }

  Kind kind_;
  std::uint32_t bits_;
  std::uint32_t tail_;  // bits behind the position
  std::uint32_t frame_bits_;
  bool gray_;
  std::uint32_t zero_;
  std::uint32_t failures_most_;
  InputFilter filter_;
  Tick rate_;
  Tick us_;
  Clock half_ = 3;
  Clock pause_ = 4;
  Clock answer_ = 1;

  State state_ = State::resting;
  Stage stage_ = Stage::acknowledge;
  Clock turn_ = 0;          // the timer is over from this edge on
  Clock take_ = never;      // the edge that takes the next bit
  Clock patience_ = never;  // the edge at which an answer is too late
  Clock looks_ = never;     // the edge that sees another level
  Clock cleared_ = 0;       // the edge at which the last reading began
  Clock began_ = 0;
  std::uint32_t left_ = 0;  // bits behind the next one
  std::uint32_t command_ = 0;
  std::uint32_t renews_ = 2;  // readings that only clear the error
  std::uint32_t shift_ = 0;
  std::uint32_t crc_ = 0;
  Reason reason_ = fine;
  bool clock_ = false;
  bool primed_ = false;
  bool takes_ = false;
  bool done_ = false;
  bool second_ = false;
  bool parity_ = false;
  bool error_ = false;
  bool warns_ = false;

  bool valid_ = false;
  bool begun_ = false;
  bool warning_ = false;
  std::uint32_t failure_ = 0;
  std::uint32_t in_a_row_ = 0;
  std::uint32_t failures_now_ = 0;
  std::uint32_t stamp_ = 0;
  std::uint32_t raw_ = 0;
  std::uint32_t position_ = 0;
  std::uint64_t fresh_since_ = 0;  // us, at the last good reading
};

}  // namespace

std::unique_ptr<Component> make_absolute_encoder(const ComponentConfiguration& from) {
  return std::make_unique<AbsoluteEncoder>(from);
}

}  // namespace unitylink::device
