// SPDX-License-Identifier: BSD-3-Clause
// The model of spi_device.vhd, with spi_master.vhd.
#include <algorithm>

#include "device/component/bus_sequencer.hpp"

namespace unitylink::device {

namespace {

class SpiDevice final : public BusSequencer {
 public:
  explicit SpiDevice(const ComponentConfiguration& from)
      : BusSequencer(from),
        at_rest_((from.generic("mode", 0) & 2) != 0),
        second_edge_((from.generic("mode", 0) & 1) != 0) {
    const auto clock_hz = from.generic("clock_hz", 50'000'000);
    const auto clock_khz = (clock_hz + 999) / 1000;
    half_clocks_ =
        static_cast<Clock>(std::max<std::int64_t>(2, (clock_hz - 1) / (2 * from.generic("sclk_hz", 1'000'000)) + 1));
    pause_clocks_ = static_cast<Clock>(
        std::max<std::int64_t>(3, (from.generic("select_ns", 100) * clock_khz + 999'999) / 1'000'000));
    if (!outputs().empty()) {         // not in a look whether there is a model
      output(select_n, true, never);  // state 0 has them
      output(sclk, at_rest_, never);
    }
  }

 private:
  enum Output : std::uint32_t { select_n, sclk, mosi };
  enum class State { idle, selecting, shifting, ending, resting };

  [[nodiscard]] Clock next_of_bus() const noexcept override { return due_; }

  void begin(const BusRequest& request, Clock edge) override {
    shift_ = request.data;
    last_ = request.last;
    output(mosi, (shift_ & 0x80u) != 0, edge);
    if (request.first) {
      output(select_n, false, edge);
      go(State::selecting, edge, pause_clocks_);
    } else {
      begin_byte(edge);
    }
  }

  void begin_byte(Clock edge) {
    half_ = 0;
    output(sclk, at_rest_ != second_edge_, edge);
    go(State::shifting, edge, half_clocks_);
  }

  void step_bus(Clock edge) override {
    switch (state_) {
      case State::selecting: begin_byte(edge); break;
      case State::shifting: turn(edge); break;
      case State::ending:
        if (last_) {
          output(select_n, true, edge);
          go(State::resting, edge, pause_clocks_);
          break;
        }
        [[fallthrough]];
      default:
        state_ = State::idle;
        due_ = never;
        reply(BusFailure::none, static_cast<std::uint8_t>(shift_), edge);
    }
  }

  // Half a bit ends. The VHDL takes the reply two clocks later, behind its synchroniser, which is the same level.
  void turn(Clock edge) {
    const bool ends = half_ == 15;
    const bool level = miso_;  // of before this edge, which may change it
    const bool second = (half_ & 1u) != 0;
    output(sclk, ends ? at_rest_ : (at_rest_ != second_edge_) != !second, edge);
    if (second) {
      output(mosi, (shift_ & 0x40u) != 0, edge);
      shift_ = (shift_ << 1 | (level ? 1u : 0u)) & 0xFFu;
    }
    ++half_;
    if (ends) {
      go(State::ending, edge, last_ ? pause_clocks_ : 2);
    } else {
      go(State::shifting, edge, half_clocks_);
    }
  }

  void go(State state, Clock edge, Clock clocks) noexcept {
    state_ = state;
    due_ = edge + clocks;
  }

  void driven(std::uint32_t /*miso*/, bool level, Clock /*edge*/) override { miso_ = level; }

  bool at_rest_;
  bool second_edge_;
  Clock half_clocks_;
  Clock pause_clocks_;
  State state_ = State::idle;
  Clock due_ = never;
  std::uint32_t half_ = 0;
  std::uint32_t shift_ = 0;
  bool last_ = false;
  bool miso_ = false;
};

}  // namespace

std::unique_ptr<Component> make_spi_device(const ComponentConfiguration& from) {
  return std::make_unique<SpiDevice>(from);
}

}  // namespace unitylink::device
