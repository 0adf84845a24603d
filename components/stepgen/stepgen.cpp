// SPDX-License-Identifier: BSD-3-Clause
// The model of stepgen.vhd: the bus, the limits and the latches. Motion and ramp are beside it. It plays whole base
// periods at once, with their steps, and the ramp with them where no position counts. Around what comes from outside,
// and for a ramp that looks at a position, it runs clock by clock. While all axes rest it runs no clock.
#include <algorithm>
#include <optional>
#include <string>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"
#include "stepgen_ramp.hpp"
#include "stepgen_rest.hpp"

namespace unitylink::device {

namespace {

constexpr std::uint32_t axis_words = 16;

std::string stepgen_words(std::uint32_t axes) {
  std::string all;
  for (std::uint32_t axis = 0; axis < axes; ++axis) {
    all += "11111000001-----";
  }
  return all;
}

class Stepgen final : public Component {
 public:
  explicit Stepgen(const ComponentConfiguration& from)
      : Component(from, stepgen_words(StepgenRates(from).axes), false),
        rates_(from),
        motion_(from, rates_),
        ramp_(rates_),
        rest_(rates_, motion_),
        filter_(3 * rates_.axes + 1, static_cast<std::uint32_t>(from.generic("stable_clocks", 1))),
        pins_(motion_.pins()) {
    wait_until(rates_.clearing_clocks);
    for (std::uint32_t axis = 0; axis < rates_.axes && !outputs().empty(); ++axis) {
      output(rates_.axes + axis, true, never);  // state 0 has DIR
    }
  }

 private:
  enum Register : std::uint32_t {
    control,
    target,
    speed,
    acceleration,
    goal,
    position,
    velocity,
    status,
    latched,
    stamp,
    shift
  };
  enum Source : std::uint32_t { none, low_limit, high_limit, home };

  [[nodiscard]] std::uint32_t all() const noexcept { return (1u << rates_.axes) - 1u; }

  // Does nothing come from outside or between the units, so that whole base periods may be played?
  [[nodiscard]] bool is_smooth() const noexcept {
    return now_ >= rates_.clearing_clocks && ramp_.is_waiting() && !is_watching_ && catches_ == 0 &&
           filter_.next() > now_;
  }
  // Base periods that end before this clock for certain.
  [[nodiscard]] std::uint64_t periods_before(Clock until) const noexcept {
    return (std::min(until, filter_.next()) - now_) / (rates_.short_clocks + 1);
  }
  // The axes whose next step changes more than the position: a limit halts them.
  [[nodiscard]] std::uint32_t halting() const noexcept {
    std::uint32_t result = 0;
    for (std::uint32_t axis = 0; axis < rates_.axes; ++axis) {
      const bool halts = (words_[axis][control] & 4u) != 0 && (level(0, axis) || level(1, axis));
      result |= halts ? 1u << axis : 0;
    }
    return result;
  }

  // Whole base periods are played until this clock. False: the next clock matters.
  bool play(Clock until) {
    if (!is_smooth()) {
      return false;
    }
    const std::uint64_t most = periods_before(until);
    const std::uint64_t to_tick = ramp_.periods_to_tick();
    // nothing from outside may come before the end of the ramp
    const bool ramps = most > to_tick + ramp_.periods();
    const std::uint64_t wanted = std::min(most, to_tick + (ramps ? 1 : 0));
    const std::uint64_t periods = motion_.playable_periods(ramp_.bank(), wanted, halting());
    if (periods == 0) {
      return false;
    }
    std::optional<StepgenRamp::Outcome> outcome;
    if (periods > to_tick) {
      outcome = ramp_.outcome(words_, motion_, all() & ~halted_, shifting_);
    }
    const std::uint64_t played = periods > to_tick && !outcome ? to_tick : periods;
    if (played == 0) {
      return false;
    }
    const Clock from = now_;
    now_ += motion_.periods().clocks_of(played);
    motion_.play(ramp_.bank(), played, [this, from](std::uint32_t pin, bool level, Clock clocks) {
      output(pin, level, from + clocks);
      rest_.show();
    });
    pins_ = motion_.pins();
    if (outcome) {
      ramp_.finish(*outcome, words_, motion_);
    } else {
      ramp_.skip(played);
    }
    return true;
  }

  // Does anybody watch a pin?
  [[nodiscard]] bool shows() const noexcept {
    bool result = false;
    for (std::uint32_t pin = 0; pin < 2 * rates_.axes; ++pin) {
      result = result || is_watched(pin);
    }
    return result;
  }

  [[nodiscard]] Clock next() const noexcept override {
    if (rest_.rests()) {
      return never;
    }
    if (!is_heard()) {
      return now_ + lag_most;
    }
    if (!is_smooth() || !motion_.begins()) {
      return now_;
    }
    std::uint64_t periods = ramp_.periods_to_tick();
    if (shows()) {
      periods = motion_.quiet_periods(ramp_.bank(), std::min(periods, periods_before(never)));
    } else {
      periods += std::uint64_t{ramp_.periods()} * ramp_.unsettling(words_);
    }
    return now_ + std::min(motion_.periods().clocks_of(periods), lag_most);
  }

  void step(Clock edge) override { run_until(edge + 1); }
  void arrive(Clock state) override { run_until(state); }

  void run_until(Clock state) {
    while (now_ < state) {
      if (now_ >= rest_.due()) {
        if (filter_.next() != never) {
          rest_.show();  // a level is about to change
        }
        rest_.look(whole(), now_);
      }
      if (rest_.rests() && motion_.begins()) {  // else an operation on the time is under way
        const Clock clocks = rest_.clocks(now_, state);
        now_ += clocks;
        motion_.pass(clocks);
        if (now_ == state) {
          break;
        }
      }
      if (!play(std::min(state, rest_.due()))) {
        clock();
      }
    }
  }

  [[nodiscard]] StepgenRest::State whole() const {
    const std::uint32_t bits = (stopped_ ? 1u : 0u) | (is_watching_ ? 2u : 0u);
    return {motion_,
            ramp_,
            words_,
            {pins_, levels_, bits, moved_ | halted_ << 8 | late_ << 16, shifting_, source_before_, armed_, catches_,
             latched_}};
  }

  [[nodiscard]] StepgenMotion::Asked asked() const noexcept {
    StepgenMotion::Asked result;
    ramp_.ask(result);
    result.catches = catches_;
    return result;
  }

  void clock() {
    const Clock edge = now_++;
    const std::uint32_t moving = ramp_.moving();
    StepgenMotion::Told told;
    if (edge < rates_.clearing_clocks) {
      motion_.clock_pulses();
    } else {
      const std::uint32_t looked = motion_.look_data();
      const std::uint32_t axis = ramp_.axis();
      told = motion_.clock(asked());
      ramp_.clock(words_, told, looked, all() & ~halted_, shifting_);
      shifting_ &= told.shifted ? ~(1u << axis) : ~0u;
    }
    watch(told);
    if ((moved_ & ~moving) != 0) {
      event(0, edge);
      rest_.show();
    }
    is_watching_ = is_watching_ || moved_ != ramp_.moving();
    moved_ = moving;
    if (filter_.step(edge)) {
      levels_ = filter_.levels();
      is_watching_ = true;
    }
    if (const std::uint32_t pins = motion_.pins(); pins != pins_) {
      for (std::uint32_t pin = 0; pin < 2 * rates_.axes; ++pin) {
        output(pin, (pins >> pin & 1u) != 0, edge);
      }
      rest_.show();
      pins_ = pins;
    }
  }

  [[nodiscard]] bool level(std::uint32_t group, std::uint32_t axis) const noexcept {
    return (levels_ >> (group * rates_.axes + axis) & 1u) != 0;
  }

  // The latches and the halts.
  void watch(const StepgenMotion::Told& told) noexcept {
    const bool is_told = told.stepped || told.late || told.caught != 0;
    if (!is_watching_ && !is_told && catches_ == 0 && stopped_ == level(3, 0)) {
      return;  // most clocks
    }
    is_watching_ = false;
    for (std::uint32_t axis = 0; axis < rates_.axes; ++axis) {
      const std::uint32_t bit = 1u << axis;
      const std::uint32_t from = words_[axis][control] >> 3 & 3u;
      const bool source = from != none && level(from - 1, axis);
      const bool before = (source_before_ & bit) != 0;
      source_before_ = source ? source_before_ | bit : source_before_ & ~bit;
      is_watching_ = is_watching_ || source != before;
      const bool catching = (catches_ & bit) != 0;
      if ((armed_ & bit) != 0 && source && !before) {
        armed_ &= ~bit;
        catches_ |= bit;
      }
      if ((told.caught & bit) != 0) {
        catches_ &= ~bit;
        latched_ = catching ? latched_ | bit : latched_ & ~bit;
      }
      if (told.axis == axis) {
        const bool limited = told.stepped && (words_[axis][control] & 4u) != 0 && level(told.down ? 0 : 1, axis);
        halted_ |= limited ? bit : 0;
        late_ |= told.late ? bit : 0;
      }
    }
    stopped_ = level(3, 0);
    halted_ |= stopped_ ? all() : 0;
  }

  // Reads and writes wait for the memory that they share with the ramp. A status is that of a clock later.
  Clock admitted(std::uint32_t address, bool writes, Clock edge) override {
    run_until(edge);
    const std::uint32_t axis = address / axis_words;
    const std::uint32_t word = address % axis_words;
    while (!is_served(axis, word)) {
      clock();
    }
    const Clock taken = now_;
    if (!writes && word == status) {
      clock();
    }
    return taken;
  }

  void look(std::uint32_t address, Clock state) override {
    run_until(state);
    const std::uint32_t axis = address / axis_words;
    const std::uint32_t place = address % axis_words;
    if (place == position || place == latched || place == stamp) {
      word(address, motion_.word(axis, part(place)), state);
    } else if (place == status) {
      word(address, status_of(axis), state);
    } else {
      word(address, words_[axis][place == velocity && ramp_.bank() ? StepgenRamp::next : place], state);
    }
  }

  [[nodiscard]] bool is_served(std::uint32_t axis, std::uint32_t word) const noexcept {
    if (word != position && word != latched && word != stamp) {
      return !ramp_.uses_words();
    }
    StepgenMotion::Asked ask = asked();
    ask.look_axis = axis;
    ask.look_part = part(word);
    return !ramp_.looks() && motion_.serves(ask);
  }
  [[nodiscard]] static StepgenMotion::Part part(std::uint32_t word) noexcept {
    return word == position ? StepgenMotion::position : word == latched ? StepgenMotion::latched : StepgenMotion::stamp;
  }

  [[nodiscard]] std::uint32_t status_of(std::uint32_t axis) const noexcept {
    const auto bit = [axis](std::uint32_t flags, std::uint32_t place) { return (flags >> axis & 1u) << place; };
    const std::uint32_t at_target = ramp_.is_near(axis) ? ~ramp_.moving() : 0;
    return bit(ramp_.moving(), 0) | bit(at_target, 1) | bit(levels_, 2) | bit(levels_ >> rates_.axes, 3) |
           bit(levels_ >> (2 * rates_.axes), 4) | bit(halted_, 5) | bit(latched_, 6) | bit(late_, 7);
  }

  [[nodiscard]] bool refuses(std::uint32_t address, std::uint32_t value) const override {
    const std::uint32_t word = address % axis_words;
    return (word == acceleration && (value & 0xFFFFFu) == 0) ||
           (word == shift && (shifting_ >> address / axis_words & 1u) != 0);
  }

  void stored(std::uint32_t address, Clock edge) override {
    run_until(edge + 1);
    rest_.disturb(now_);
    const std::uint32_t axis = address / axis_words;
    const std::uint32_t word = address % axis_words;
    const std::uint32_t bit = 1u << axis;
    const std::uint32_t mask = word == speed ? 0xFFFFFFFu : word == acceleration ? 0xFFFFFu : ~0u;
    words_[axis][word] = write_word(address) & mask;
    if (word == shift) {
      shifting_ |= bit;
    } else if (word == control) {
      source_before_ |= bit;  // a level that is high now is no edge
      armed_ |= bit;
      catches_ &= ~bit;
      latched_ &= ~bit;
      late_ &= ~bit;
      halted_ = stopped_ ? all() : halted_ & ~bit;
      is_watching_ = true;
    }
  }

  void driven(std::uint32_t pin, bool level, Clock edge) override {
    run_until(edge);
    rest_.disturb(now_);
    filter_.drive(pin, level, edge);
  }

  StepgenRates rates_;
  StepgenMotion motion_;
  StepgenRamp ramp_;
  StepgenRest rest_;
  InputFilter filter_;
  StepgenRamp::Words words_{};
  std::uint32_t pins_;        // STEP of each axis, then DIR of each
  Clock now_ = 0;             // every edge before this one has happened
  std::uint32_t levels_ = 0;  // behind the filter
  bool stopped_ = false;      // the level of `stop` that the last edge saw
  bool is_watching_ = false;  // a flag is about to change
  // A bit for each axis.
  std::uint32_t moved_ = 0, halted_ = 0, late_ = 0, shifting_ = 0, source_before_ = 0, armed_ = 0, catches_ = 0,
                latched_ = 0;
};

}  // namespace

std::unique_ptr<Component> make_stepgen(const ComponentConfiguration& from) { return std::make_unique<Stepgen>(from); }

}  // namespace unitylink::device
