// SPDX-License-Identifier: BSD-3-Clause
// The model of sonar.vhd.
#include <algorithm>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"
#include "device/component/sample_state.hpp"
#include "device/component/ticker.hpp"

namespace unitylink::device {

namespace {

class Sonar final : public Component {
 public:
  explicit Sonar(const ComponentConfiguration& from)
      : Component(from, "100", false),
        period_(static_cast<std::uint64_t>(from.generic("period_us", 60'000))),
        timeout_(static_cast<std::uint64_t>(from.generic("timeout_us", 30'000))),
        ticker_(from),
        filter_(1, 1),
        state_(from),
        due_(ticker_.state_of(period_)) {
    initial_word(control, 1);
  }

 private:
  static constexpr std::uint64_t trigger_us = 12;

  enum Register : std::uint32_t { control, state, distance };
  enum Reason : std::uint32_t { fine, no_answer, out_of_range, stuck };
  enum Event : std::uint32_t { sampled, failed };

  [[nodiscard]] bool enable() const noexcept { return (write_word(control) & 1u) != 0; }

  [[nodiscard]] Clock next() const noexcept override { return ended_ ? 0 : std::min(due_, filter_.next()); }

  void step(Clock edge) override {
    const bool was_ended = ended_;
    if (ended_ && !is_held(edge)) {
      ended_ = false;
      state_.take(reason_);
      event(reason_ == fine ? sampled : failed, edge);
      if (reason_ == fine) {
        value_ = length_;
      }
    }
    if (ticker_.is_tick(edge)) {
      tick(edge, was_ended);
    }
    if (!enable()) {
      armed_ = hears_ = ended_ = triggers_ = false;
      state_.make_void();
    }
    output(0, triggers_, edge);
    word(state, state_.word(), edge);
    word(distance, value_, edge);
    wire(0, {value_, state_.is_valid()}, edge);
    filter_.step(edge);
    plan(edge);
  }

  void tick(Clock edge, bool was_ended) {
    const bool level = level_;
    const bool heard = hears_;
    const bool was_armed = armed_;
    const std::uint64_t number = ticker_.until(edge);
    if (filter_.level(0) == before_) {
      level_ = before_;
    }
    before_ = filter_.level(0);
    if (number == trigger_end_) {
      triggers_ = false;
    }
    if (armed_ && level) {
      if (!hears_) {
        rose_ = number;
      }
      hears_ = true;
    } else if (hears_) {
      const std::uint64_t length = std::min(number - rose_, timeout_);
      length_ = static_cast<std::uint32_t>(length);
      armed_ = hears_ = false;
      end(length == timeout_ ? out_of_range : fine);
    }
    if (number % period_ != 0) {
      return;
    }
    if (level) {
      armed_ = hears_ = false;
      end(stuck);
    } else if (!heard && !was_ended) {
      if (was_armed) {
        end(no_answer);
      }
      armed_ = triggers_ = true;
      trigger_end_ = number + trigger_us;
    }
  }

  void end(Reason why) noexcept {
    reason_ = why;
    ended_ = true;
  }

  // The next tick that changes something.
  void plan(Clock edge) noexcept {
    const bool raw = filter_.level(0);
    const std::uint64_t number = ticker_.until(edge);
    if (raw != before_ || raw != level_ || (armed_ && level_ != hears_)) {
      due_ = ticker_.state_of(number + 1);
    } else {
      const std::uint64_t last = (number / period_ + 1) * period_;
      due_ = ticker_.state_of(triggers_ ? std::min(trigger_end_, last) : last);
    }
  }

  void stored(std::uint32_t /*control*/, Clock edge) override { word(control, write_word(control) & 1u, edge); }

  void driven(std::uint32_t /*echo*/, bool level, Clock edge) override { filter_.drive(0, level, edge); }

  std::uint64_t period_;
  std::uint64_t timeout_;
  Ticker ticker_;
  InputFilter filter_;
  SampleState state_;
  Clock due_;                      // the next tick that changes something
  std::uint64_t trigger_end_ = 0;  // the tick that ends the trigger
  std::uint64_t rose_ = 0;         // the tick at which the echo began
  std::uint32_t length_ = 0;       // of the last echo
  std::uint32_t value_ = 0;
  Reason reason_ = fine;
  bool before_ = false;  // the echo, a us ago
  bool level_ = false;   // and behind the filter
  bool triggers_ = false;
  bool armed_ = false;
  bool hears_ = false;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<Component> make_sonar(const ComponentConfiguration& from) { return std::make_unique<Sonar>(from); }

}  // namespace unitylink::device
