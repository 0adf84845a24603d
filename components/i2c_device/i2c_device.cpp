// SPDX-License-Identifier: BSD-3-Clause
// The model of i2c_device.vhd, with i2c_device_master.vhd.
#include <algorithm>
#include <array>
#include <utility>

#include "device/component/bus_sequencer.hpp"

namespace unitylink::device {

namespace {

// A pin behind a synchroniser of two flip-flops.
class Line {
 public:
  void drive(bool level, Clock edge) noexcept {
    settle(edge);
    if (count_ == 0 || changes_[count_ - 1].edge != edge) {
      ++count_;
    }
    changes_[count_ - 1] = {edge, level};
  }
  [[nodiscard]] bool at(Clock edge) noexcept {
    settle(edge);
    return level_;
  }

 private:
  struct Change {
    Clock edge = 0;
    bool level = false;
  };

  void settle(Clock edge) noexcept {
    while (count_ > 0 && changes_[0].edge + 2 <= edge) {
      level_ = changes_[0].level;
      std::copy(changes_.begin() + 1, changes_.begin() + count_, changes_.begin());
      --count_;
    }
  }

  std::array<Change, 4> changes_{};  // at most two are under way, and one more has just come
  std::uint32_t count_ = 0;
  bool level_ = false;
};

class I2cDevice final : public BusSequencer {
 public:
  explicit I2cDevice(const ComponentConfiguration& from) : BusSequencer(from) {
    const auto clock_hz = from.generic("clock_hz", 50'000'000);
    const auto scl_hz = from.generic("scl_hz", 400'000);
    const auto clock_khz = (clock_hz + 999) / 1000;
    std::int64_t quarter = std::max<std::int64_t>(4, (clock_hz - 1) / (4 * scl_hz) + 1);
    if (scl_hz > 100'000 && scl_hz <= 400'000) {
      quarter = std::max<std::int64_t>(quarter, (650 * clock_khz + 999'999) / 1'000'000);
    }
    quarter_clocks_ = static_cast<Clock>(quarter);
    patience_ =
        static_cast<std::uint32_t>(1 + from.generic("stretch_us", 1000) * ((clock_hz + 999'999) / 1'000'000) / quarter);
  }

 private:
  enum Input : std::uint32_t { scl_in, sda_in };
  enum Output : std::uint32_t { scl_out, scl_drive, sda_out, sda_drive };
  enum class State { idle, starting, shifting, stopping, freeing };

  [[nodiscard]] Clock next_of_bus() const noexcept override { return due_; }

  void begin(const BusRequest& request, Clock edge) override {
    shift_ = request.data;
    last_ = request.last;
    receive_ = request.receive;
    bits_ = 0;
    waited_ = 0;
    bad_ = false;
    again_ = dirty_;
    go(dirty_ ? State::freeing : request.first ? State::starting : State::shifting);
    due_ = edge + quarter_clocks_;
  }

  void step_bus(Clock edge) override {
    const bool held = quarter_ == 2 && !scl_.at(edge);
    due_ = edge + quarter_clocks_;
    if (held && waited_ != patience_) {
      ++waited_;
      return;
    }
    if (held) {
      bad_ = true;
      dirty_ = true;
    }
    const std::uint32_t quarter = quarter_;
    quarter_ = (quarter_ + 1) % 4;
    const bool sda = sda_.at(edge);
    switch (state_) {
      case State::starting: start(quarter, sda, edge); break;
      case State::shifting: shift(quarter, sda, edge); break;
      case State::stopping: stop(quarter, sda, edge); break;
      default: free(quarter, sda, held, edge);
    }
  }

  void start(std::uint32_t quarter, bool sda, Clock edge) {
    switch (quarter) {
      case 0: output(sda_drive, false, edge); break;
      case 1: output(scl_drive, false, edge); break;
      case 2:
        bad_ = bad_ || !sda;
        dirty_ = dirty_ || !sda;
        output(sda_drive, true, edge);
        break;
      default: output(scl_drive, true, edge); go(bad_ ? State::freeing : State::shifting);
    }
  }

  void shift(std::uint32_t quarter, bool sda, Clock edge) {
    switch (quarter) {
      case 0: output(sda_drive, bits_ == 8 ? receive_ && !last_ : !receive_ && (shift_ & 0x80u) == 0, edge); break;
      case 1: output(scl_drive, false, edge); break;
      case 2:
        if (bits_ != 8) {
          shift_ = (shift_ << 1 | (sda ? 1u : 0u)) & 0xFFu;
        } else if (sda && !receive_) {
          bad_ = true;
        }
        break;
      default:
        output(scl_drive, true, edge);
        if (bits_++ == 8) {
          bits_ = 0;
          if (last_ || bad_) {
            go(State::stopping);
          } else {
            finish(false, edge);
          }
        }
    }
  }

  void stop(std::uint32_t quarter, bool sda, Clock edge) {
    switch (quarter) {
      case 0: output(sda_drive, true, edge); break;
      case 1: output(scl_drive, false, edge); break;
      case 2: output(sda_drive, false, edge); break;
      default: {
        const bool good = !bad_ && !dirty_ && sda;
        dirty_ = dirty_ || !sda;
        if (std::exchange(again_, false) && good) {
          go(State::starting);
        } else {
          finish(!good, edge);
        }
      }
    }
  }

  // Pulses of scl until sda is high.
  void free(std::uint32_t quarter, bool sda, bool held, Clock edge) {
    switch (quarter) {
      case 0: output(sda_drive, false, edge); break;
      case 1: output(scl_drive, false, edge); break;
      case 2: dirty_ = held; break;
      default:
        output(scl_drive, true, edge);
        if (sda || bits_ == 9) {
          bits_ = 0;
          go(State::stopping);
        } else {
          ++bits_;
        }
    }
  }

  void finish(bool failed, Clock edge) {
    state_ = State::idle;
    due_ = never;
    reply(failed ? BusFailure::no_answer : BusFailure::none, static_cast<std::uint8_t>(shift_), edge);
  }

  void go(State state) noexcept {
    state_ = state;
    quarter_ = 0;
  }

  void driven(std::uint32_t pin, bool level, Clock edge) override { (pin == scl_in ? scl_ : sda_).drive(level, edge); }

  Clock quarter_clocks_;
  std::uint32_t patience_;  // quarters for which scl may be held low
  Line scl_;
  Line sda_;
  State state_ = State::idle;
  Clock due_ = never;
  std::uint32_t quarter_ = 0;
  std::uint32_t bits_ = 0;
  std::uint32_t waited_ = 0;
  std::uint32_t shift_ = 0;
  bool last_ = false;
  bool receive_ = false;
  bool bad_ = false;
  bool again_ = false;
  bool dirty_ = true;  // somebody may be inside a byte
};

}  // namespace

std::unique_ptr<Component> make_i2c_device(const ComponentConfiguration& from) {
  return std::make_unique<I2cDevice>(from);
}

}  // namespace unitylink::device
