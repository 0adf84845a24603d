// SPDX-License-Identifier: BSD-3-Clause
// The models of uart_tx.vhd and uart_rx.vhd: bytes on an asynchronous line, clock by clock.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "device/clock.hpp"
#include "device/component/tick.hpp"

namespace unitylink::device {

enum class Parity : std::uint32_t { none, even, odd };

// A line that bytes are sent on. The caller watches the level behind each step.
class UartTransmitter {
 public:
  UartTransmitter(std::uint64_t clock_hz, std::uint64_t baud_hz, Parity parity = Parity::none,
                  std::uint32_t stop_bits = 1)
      : rate_(clock_hz, baud_hz), parity_(parity), frame_bits_(9 + (parity != Parity::none ? 1 : 0) + stop_bits) {}

  // May a byte be taken in this state?
  [[nodiscard]] bool is_ready(Clock state) const noexcept { return left_ == 0 || (left_ == 1 && state == next_); }
  // A byte is taken at `edge`. Its start bit begins in the next state.
  void take(std::uint8_t byte, Clock edge) noexcept {
    if (left_ == 0) {
      begun_ = edge;
      ticks_ = 0;
    } else {
      ++ticks_;  // the last bit of the byte before ends at this edge
    }
    std::uint32_t check = 1;
    if (parity_ != Parity::none) {
      check = parity_ == Parity::odd ? 1 : 0;
      for (std::uint32_t bit = 0; bit < 8; ++bit) {
        check ^= byte >> bit & 1u;
      }
    }
    shift_ = ~0x3FFu | check << 9 | static_cast<std::uint32_t>(byte) << 1;
    left_ = frame_bits_;
    await();
  }
  // The next edge at which a bit ends.
  [[nodiscard]] Clock next() const noexcept { return left_ == 0 ? never : next_; }
  // Edge `edge` happens, and no byte is taken at it.
  void step(Clock edge) noexcept {
    if (left_ != 0 && edge == next_) {
      ++ticks_;
      --left_;
      shift_ = shift_ >> 1 | 0x8000'0000u;
      await();
    }
  }
  [[nodiscard]] bool level() const noexcept { return (shift_ & 1u) != 0; }

 private:
  void await() noexcept { next_ = begun_ + rate_.state_of(ticks_ + 1); }

  Tick rate_;
  Parity parity_;
  std::uint32_t frame_bits_;
  std::uint32_t shift_ = ~0u;
  std::uint32_t left_ = 0;   // bits of the frame that are still to end
  Clock begun_ = 0;          // since when the phase runs
  std::uint64_t ticks_ = 0;  // since then
  Clock next_ = never;
};

// A line that bytes are received from.
class UartReceiver {
 public:
  UartReceiver(std::uint64_t clock_hz, std::uint64_t baud_hz, Parity parity = Parity::none)
      : rate_(clock_hz, baud_hz),
        parity_(parity),
        start_((std::uint64_t{1} << (rate_.bits() - 1)) + 2 * rate_.increment()) {}

  // Edge `edge` is the first to sample this level. Calls come in the order of time.
  void drive(bool level, Clock edge) noexcept {
    settle(edge);
    if (count_ == 0 || changes_[count_ - 1].edge != edge) {
      ++count_;
    }
    changes_[count_ - 1] = {edge, level};
    moves_until_ = std::max(moves_until_, edge + 5);
    next_ = std::min(next_, edge);
  }
  // The line is high at first, unlike the pins: it is an inverted one.
  void begin_high() noexcept { settled_ = true; }
  // From the next edge on it has this rate. It is in reset then.
  void tune(std::uint64_t clock_hz, std::uint64_t baud_hz) {
    rate_ = Tick(clock_hz, baud_hz);
    start_ = (std::uint64_t{1} << (rate_.bits() - 1)) + 2 * rate_.increment();
  }
  // The line behind the synchroniser, in the state before `edge`. Edges come in the order of time.
  [[nodiscard]] bool settled(Clock edge) noexcept {
    settle(edge);
    return settled_;
  }
  // The reset is released: `edge` is the last one with it.
  void release(Clock edge) noexcept {
    samples_ = {true, true};
    level_ = true;
    state_ = State::recover;
    due_ = never;
    moves_until_ = std::max(moves_until_, edge + 5);
    next_ = edge + 1;
  }
  // The next edge at which something may change.
  [[nodiscard]] Clock next() const noexcept { return std::min(next_, due_); }
  // Edge `edge` happens. True: a character has ended, which shows in the next state.
  bool step(Clock edge) noexcept {
    if (edge < next()) {
      return false;
    }
    settle(edge);
    const State before = state_;
    const bool ended = run(edge);
    const bool settled = settled_;
    level_ = (settled && samples_[0]) || (samples_[0] && samples_[1]) || (settled && samples_[1]);
    samples_ = {settled, samples_[0]};
    next_ = edge < moves_until_ || state_ != before ? edge + 1 : never;
    return ended;
  }

  [[nodiscard]] std::uint8_t data() const noexcept { return static_cast<std::uint8_t>(shift_); }
  [[nodiscard]] bool framing_error() const noexcept { return framing_; }
  [[nodiscard]] bool parity_error() const noexcept { return parity_wrong_; }

 private:
  enum class State { recover, idle, start, data, parity_bit, stop };
  struct Change {
    Clock edge = 0;
    bool level = false;
  };

  // The synchroniser: what edge n samples is behind it in state n + 2.
  void settle(Clock edge) noexcept {
    while (count_ > 0 && changes_[0].edge + 2 <= edge) {
      settled_ = changes_[0].level;
      std::copy(changes_.begin() + 1, changes_.begin() + count_, changes_.begin());
      --count_;
    }
  }

  bool run(Clock edge) noexcept {
    const bool tick = edge == due_;
    switch (state_) {
      case State::recover:
        if (level_) {
          state_ = State::idle;
        }
        break;
      case State::idle:
        if (!level_) {
          state_ = State::start;
          begun_ = edge + 1;
          ticks_ = 0;
          bits_ = 0;
          odd_ = false;
          await();
        }
        break;
      case State::start:
        if (tick) {
          state_ = level_ ? State::idle : State::data;
          level_ ? rest() : await();
        }
        break;
      case State::data:
        if (tick) {
          shift_ = shift_ >> 1 | (level_ ? 0x80u : 0u);
          odd_ = odd_ != level_;
          if (++bits_ == 8) {
            state_ = parity_ == Parity::none ? State::stop : State::parity_bit;
          }
          await();
        }
        break;
      case State::parity_bit:
        if (tick) {
          odd_ = odd_ != level_;
          state_ = State::stop;
          await();
        }
        break;
      case State::stop:
        if (tick) {
          framing_ = !level_;
          parity_wrong_ = parity_ != Parity::none && odd_ == (parity_ == Parity::even);
          state_ = level_ ? State::idle : State::recover;
          rest();
          return true;
        }
        break;
    }
    return false;
  }

  // A phase that is `start_` in the state `begun_` has its next tick then.
  void await() noexcept {
    ++ticks_;
    const std::uint64_t wanted = (ticks_ << rate_.bits()) - start_;
    due_ = begun_ + static_cast<Clock>((wanted + rate_.increment() - 1) / rate_.increment());
  }
  void rest() noexcept { due_ = never; }

  Tick rate_;
  Parity parity_;
  std::uint64_t start_;
  std::array<Change, 4> changes_{};  // at most two are under way, and one more has just come
  std::uint32_t count_ = 0;
  bool settled_ = false;  // all pins are low at first
  std::array<bool, 2> samples_{true, true};
  bool level_ = true;
  State state_ = State::recover;
  Clock next_ = 0;
  Clock moves_until_ = 5;
  Clock due_ = never;
  Clock begun_ = 0;
  std::uint64_t ticks_ = 0;
  std::uint32_t bits_ = 0;
  std::uint32_t shift_ = 0;
  bool odd_ = false;
  bool framing_ = false;
  bool parity_wrong_ = false;
};

}  // namespace unitylink::device
