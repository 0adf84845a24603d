// SPDX-License-Identifier: BSD-3-Clause
// The model of one_wire.vhd.
#include <algorithm>
#include <array>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"
#include "device/component/sample_state.hpp"
#include "device/component/ticker.hpp"

namespace unitylink::device {

namespace {

class OneWire final : public Component {
 public:
  explicit OneWire(const ComponentConfiguration& from)
      : Component(from, "100", false),
        period_(static_cast<std::uint64_t>(from.generic("period_ms", 1000)) * 1000 / unit_us),
        unused_bits_(static_cast<std::uint32_t>(12 - from.generic("resolution", 12))),
        is_parasite_(from.generic("parasite", 0) != 0),
        converted_((((750u + (1u << unused_bits_) - 1) >> unused_bits_) + 10) * 1000 / unit_us),
        ticker_(from),
        filter_(1, 1),
        tries_(from),
        at_(ticker_.state_of(unit_us)) {
    initial_word(control, 1);
  }

 private:
  static constexpr std::uint64_t unit_us = 8;
  // Places in a slot.
  static constexpr std::uint32_t begin = 0, short_end = 6, sample_at = 13, long_end = 61, slot_end = 69;
  static constexpr std::uint32_t presence_at = 70, reset_end = 121;
  static constexpr std::array<std::uint32_t, 5> slot_places{begin, short_end, sample_at, long_end, slot_end};
  static constexpr std::array<std::uint32_t, 4> reset_places{begin, long_end, presence_at, reset_end};
  // Steps of a try. The bytes are those that each sends; a read sends ones.
  enum Step : std::uint32_t {
    starts = 0,
    resolves = 5,
    starts_again = 6,
    converts = 8,
    waits = 9,
    starts_to_read = 10,
    reads = 13,
    rests = 14
  };
  static constexpr std::uint32_t mark = 0x69;
  static constexpr std::array<std::uint32_t, rests> bytes{0,    0xCC, 0x4E, mark, mark, 0x1F, 0,
                                                          0xCC, 0x44, 0xFF, 0,    0xCC, 0xBE, 0xFF};

  enum Register : std::uint32_t { control, state, temperature };
  enum Output : std::uint32_t { line_out, line_drive };
  enum Reason : std::uint32_t { fine, no_answer, wrong_check, not_converted, shorted };
  enum Event : std::uint32_t { sampled, failed };

  [[nodiscard]] bool enable() const noexcept { return (write_word(control) & 1u) != 0; }
  [[nodiscard]] bool is_reset() const noexcept {
    return step_ == starts || step_ == starts_again || step_ == starts_to_read;
  }
  [[nodiscard]] bool sent() const noexcept {
    const std::uint32_t more = step_ == resolves ? (3 - unused_bits_) << 5 : 0;
    return ((bytes[step_] | more) >> (count_ & 7u) & 1u) != 0;
  }
  // The place of this slot that comes next, and the tick that has it.
  [[nodiscard]] std::uint32_t place() const noexcept { return is_reset() ? reset_places[next_] : slot_places[next_]; }
  [[nodiscard]] std::uint64_t tick_of_place() const noexcept {
    return is_reset() ? unit_us * (slot_ / unit_us + 1 + place()) : slot_ + 1 + place();
  }
  // A period begins with each of these ticks.
  [[nodiscard]] bool is_due(std::uint64_t tick) const noexcept {
    return tick % unit_us == 0 && (tick / unit_us - 1) % period_ == 0;
  }
  [[nodiscard]] std::uint64_t due_behind(std::uint64_t tick) const noexcept {
    return tick < unit_us ? unit_us : unit_us * (1 + ((tick / unit_us - 1) / period_ + 1) * period_);
  }

  [[nodiscard]] Clock next() const noexcept override { return ended_ ? 0 : std::min(at_, filter_.next()); }

  void step(Clock edge) override {
    if (ended_ && !is_held(edge)) {
      ended_ = false;
      tries_.take(reason_);
      event(reason_ == fine ? sampled : failed, edge);
      if (reason_ == fine) {
        value_ = shift_ >> unused_bits_ << unused_bits_;
      }
    }
    if (ticker_.is_tick(edge)) {
      const std::uint64_t number = ticker_.until(edge);
      const std::uint32_t before = step_;
      if (step_ != rests && number == tick_of_place()) {
        come_to(place(), number);
      }
      if (is_due(number)) {
        begin_period(before, number);
      }
    }
    if (!enable()) {
      low_ = feeds_ = ended_ = false;
      step_ = rests;
      tries_.make_void();
    }
    output(line_out, feeds_, edge);
    output(line_drive, low_ || feeds_, edge);
    word(state, tries_.word(), edge);
    word(temperature, value_, edge);
    filter_.step(edge);
    const std::uint64_t number = ticker_.until(edge);
    const std::uint64_t due = due_behind(number);
    at_ = ticker_.state_of(step_ == rests ? due : std::min(due, tick_of_place()));
  }

  void begin_period(std::uint32_t before, std::uint64_t number) noexcept {
    low_ = feeds_ = was_busy_ = lost_ = false;
    crc_ = count_ = 0;
    if (before != rests) {
      fail(not_converted);
    } else if (enable() && !ended_) {
      step_ = starts;
      go(number);
    }
  }

  void come_to(std::uint32_t place, std::uint64_t number) noexcept {
    const bool raw = filter_.level(0);
    ++next_;
    switch (place) {
      case begin: low_ = low_ || !feeds_; break;
      case short_end: low_ = low_ && !sent(); break;
      case long_end:
        low_ = false;
        feeds_ = feeds_ || (step_ == converts && count_ == 7 && is_parasite_);
        break;
      case sample_at:
        got_ = raw;
        if (step_ == reads) {
          take(raw);
        }
        break;
      case presence_at: got_ = raw; break;
      case slot_end: end_slot(number); break;
      default: end_reset(raw, number); break;
    }
  }

  void take(bool raw) noexcept {
    const bool topples = ((crc_ & 1u) != 0) != raw;
    crc_ = crc_ >> 1 ^ (topples ? 0x8Cu : 0u);
    if (count_ < 16) {
      shift_ = shift_ >> 1 | (raw ? 0x8000u : 0u);
    } else if (count_ < 32) {
      lost_ = lost_ || raw != ((mark >> (count_ & 7u) & 1u) != 0);
    }
  }

  void end_reset(bool raw, std::uint64_t number) noexcept {
    if (!raw) {
      fail(shorted);
    } else if (got_) {
      fail(no_answer);
    } else {
      go_on();
    }
    go(number);
  }

  void end_slot(std::uint64_t number) noexcept {
    if (step_ == waits) {
      wait(number);
    } else if (step_ == reads) {
      if (count_ == 71) {
        fail(crc_ != 0 ? wrong_check : lost_ ? not_converted : fine);
      }
      ++count_;
    } else if (count_ == 7) {
      go_on();
    } else {
      ++count_;
    }
    go(number);
  }

  void wait(std::uint64_t number) noexcept {
    if (is_parasite_) {
      if ((period_ - 1 + (number - 1) / unit_us) % period_ >= converted_) {
        feeds_ = false;
        go_on();
      }
    } else if (!got_) {
      was_busy_ = true;
    } else if (was_busy_) {
      go_on();
    } else {
      fail(not_converted);
    }
  }

  void fail(Reason why) noexcept {
    ended_ = true;
    reason_ = why;
    step_ = rests;
  }
  void go_on() noexcept {
    ++step_;
    count_ = 0;
  }
  void go(std::uint64_t number) noexcept {
    slot_ = number;
    next_ = 0;
  }

  void stored(std::uint32_t /*control*/, Clock edge) override { word(control, write_word(control) & 1u, edge); }

  void driven(std::uint32_t /*line_in*/, bool level, Clock edge) override { filter_.drive(0, level, edge); }

  std::uint64_t period_;  // in units
  std::uint32_t unused_bits_;
  bool is_parasite_;
  std::uint64_t converted_;  // in units
  Ticker ticker_;
  InputFilter filter_;
  SampleState tries_;
  Clock at_;  // the next edge at which something changes
  std::uint32_t step_ = rests;
  std::uint64_t slot_ = 0;  // the tick behind which this slot begins
  std::size_t next_ = 0;    // the place of it that comes next
  std::uint32_t count_ = 0;
  std::uint32_t crc_ = 0;
  std::uint32_t shift_ = 0;
  std::uint32_t value_ = 0;
  Reason reason_ = fine;
  bool got_ = false;
  bool low_ = false;
  bool feeds_ = false;
  bool was_busy_ = false;
  bool lost_ = false;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<Component> make_one_wire(const ComponentConfiguration& from) { return std::make_unique<OneWire>(from); }

}  // namespace unitylink::device
