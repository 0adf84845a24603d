// SPDX-License-Identifier: BSD-3-Clause
// The model of hx711.vhd.
#include <algorithm>

#include "device/component/component.hpp"
#include "device/component/input_filter.hpp"
#include "device/component/sample_state.hpp"
#include "device/component/ticker.hpp"

namespace unitylink::device {

namespace {

class Hx711 final : public Component {
 public:
  explicit Hx711(const ComponentConfiguration& from)
      : Component(from, "100", false),
        settle_(static_cast<std::uint32_t>(from.generic("settle", 4))),
        timeout_(static_cast<std::uint64_t>(from.generic("timeout_us", 600'000))),
        ticker_(from),
        filter_(1, 1),
        tries_(from),
        due_(ticker_.state_of(1)) {
    initial_word(control, 1);
  }

 private:
  static constexpr std::uint64_t reset_us = 64;
  static constexpr std::uint32_t bits = 24;
  static constexpr std::uint32_t mask = (1u << bits) - 1;

  enum Register : std::uint32_t { control, state, value };
  enum Reason : std::uint32_t { fine, no_answer, out_of_range, stuck };
  enum Event : std::uint32_t { sampled, failed };
  enum class State { down, waiting, shifting, judging };

  [[nodiscard]] bool enable() const noexcept { return (write_word(control) & 1u) != 0; }
  [[nodiscard]] std::uint32_t wanted() const noexcept { return std::min(write_word(control) >> 1 & 3u, 2u); }

  [[nodiscard]] Clock next() const noexcept override { return ended_ ? 0 : std::min(due_, filter_.next()); }

  void step(Clock edge) override {
    const State before = state_;
    const bool other = wanted() != chosen_;
    const bool is_pending = ended_;
    if (is_pending && !is_held(edge)) {
      ended_ = false;
      tries_.take(reason_);
      event(reason_ == fine ? sampled : failed, edge);
      if (reason_ == fine) {
        value_ = shift_;
      }
    }
    if (ticker_.is_tick(edge)) {
      tick(edge, other, is_pending);
    }
    if (!enable() && before != State::down) {
      ended_ = false;
      sck_ = true;
      go(State::down, edge);
    }
    if (!enable() || other) {
      tries_.make_void();
    }
    output(0, sck_, edge);
    word(state, tries_.word(), edge);
    word(value, value_, edge);
    wire(0, {value_ | ((value_ >> (bits - 1)) != 0 ? ~mask : 0u), tries_.is_valid()}, edge);
    filter_.step(edge);
    plan(edge);
  }

  void tick(Clock edge, bool other, bool is_pending) {
    const bool raw = filter_.level(0);
    const bool was = was_;
    const std::uint64_t now = ticker_.until(edge) - 1 - began_;  // us in this state
    was_ = raw;
    switch (state_) {
      case State::down:
        sck_ = true;
        left_ = settle_ + 1;
        if (now >= reset_us && enable()) {
          sck_ = false;
          go(State::waiting, edge);
        }
        break;
      case State::waiting:
        if (is_pending) {
          began_ = ticker_.until(edge);
        } else if (!raw && !was) {
          chosen_ = wanted();
          left_ = other ? settle_ + 1 : left_;
          go(State::shifting, edge);
        } else if (now == timeout_ - 1) {
          end(no_answer);
          go(State::down, edge);
        }
        break;
      case State::shifting:
        sck_ = now % 2 == 0;
        if (!sck_) {
          shift(now / 2, raw, edge);
        }
        break;
      case State::judging: judge(edge, raw, other); break;
    }
  }

  void shift(std::uint64_t bit, bool raw, Clock edge) noexcept {
    if (bit < bits) {
      const bool differs = raw != ((shift_ & 1u) != 0);
      at_rail_ = bit == 0 || (bit == 1 ? differs : at_rail_ && !differs);
      shift_ = (shift_ << 1 | static_cast<std::uint32_t>(raw)) & mask;
    } else if (bit == bits + chosen_) {
      go(State::judging, edge);
    }
  }

  void judge(Clock edge, bool raw, bool other) noexcept {
    reason_ = at_rail_ ? out_of_range : fine;
    if (!raw) {
      end(stuck);
      go(State::down, edge);
      return;
    }
    go(State::waiting, edge);
    if (left_ != 0) {
      --left_;
    } else if (!other) {
      ended_ = true;
    }
  }

  void end(Reason why) noexcept {
    reason_ = why;
    ended_ = true;
  }

  void go(State target, Clock edge) noexcept {
    state_ = target;
    began_ = ticker_.until(edge);
  }

  // The next tick that changes something.
  void plan(Clock edge) noexcept {
    const std::uint64_t following = ticker_.until(edge) + 1;
    const bool raw = filter_.level(0);
    std::uint64_t number = following;
    if (raw == was_ && state_ == State::down && sck_) {
      if (!enable()) {
        due_ = never;
        return;
      }
      number = std::max(following, began_ + 1 + reset_us);
    } else if (raw == was_ && state_ == State::waiting && raw) {
      number = began_ + timeout_;
    }
    due_ = ticker_.state_of(number);
  }

  void stored(std::uint32_t /*control*/, Clock edge) override { word(control, write_word(control) & 7u, edge); }

  void driven(std::uint32_t /*dout*/, bool level, Clock edge) override { filter_.drive(0, level, edge); }

  std::uint32_t settle_;
  std::uint64_t timeout_;
  Ticker ticker_;
  InputFilter filter_;
  SampleState tries_;
  Clock due_;  // the next tick that changes something
  State state_ = State::down;
  std::uint64_t began_ = 0;  // the tick since which it is in this state
  std::uint32_t chosen_ = 0;
  std::uint32_t left_ = 0;  // conversions to drop
  std::uint32_t shift_ = 0;
  std::uint32_t value_ = 0;
  Reason reason_ = fine;
  bool was_ = true;  // dout, a us ago
  bool sck_ = false;
  bool at_rail_ = false;
  bool ended_ = false;
};

}  // namespace

std::unique_ptr<Component> make_hx711(const ComponentConfiguration& from) { return std::make_unique<Hx711>(from); }

}  // namespace unitylink::device
