// SPDX-License-Identifier: BSD-3-Clause
// The model of rc_receiver_sbus.vhd: frames of 25 characters.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "device/component/tick.hpp"
#include "device/component/uart_line.hpp"
#include "rc_receiver_frame.hpp"

namespace unitylink::device {

class SbusFrames final : public RcFrames {
 public:
  SbusFrames(std::uint64_t clock_hz, bool inverted)
      : tick_(clock_hz, 1'000'000),
        receiver_(clock_hz, 100'000, Parity::even),
        inverted_(inverted),
        paused_(tick_.state_of(pause_us) + 1) {
    if (inverted) {
      receiver_.begin_high();
    }
  }

  void drive(bool level, Clock edge) override { receiver_.drive(level != inverted_, edge); }
  [[nodiscard]] Clock next() const noexcept override { return std::min({receiver_.next(), came_, paused_, put_}); }

  RcFrame step(Clock edge) override {
    RcFrame found;
    if (edge == put_) {
      put_ = never;
      found.put = true;
    }
    if (edge == came_) {
      came_ = never;
      take(edge, found);
      paused_ = tick_.state_of(tick_.until(edge) + pause_us) + 1;
    } else if (edge == paused_) {
      paused_ = never;
      found.broken = place_ > 0;
      place_ = 0;
      is_ready_ = true;
    }
    if (receiver_.step(edge)) {
      came_ = edge + 1;
    }
    return found;
  }

 private:
  static constexpr std::uint64_t pause_us = 600;
  static constexpr std::uint32_t flags_place = 23;
  static constexpr std::uint32_t last_place = 24;
  static constexpr std::uint32_t lowest = 7040;

  void take(Clock edge, RcFrame& found) noexcept {
    const bool is_right = !receiver_.framing_error() && !receiver_.parity_error();
    const std::uint32_t byte = receiver_.data();
    if (place_ > 0) {
      found.broken = !is_right;
      if (place_ < flags_place) {
        bytes_[place_ - 1] = byte;
        if (place_ == 2) {
          put_ = edge + 4;  // the third bit of this byte is the last one of the first channel
        }
      } else if (place_ == flags_place) {
        flags_ = byte & 0xFu;
      } else {
        const bool is_end = byte == 0 || (byte & 0xCFu) == 0x04;
        found.broken = !is_right || !is_end;
        found.whole = !found.broken;
        if (found.whole) {
          unpack();
        }
      }
      place_ = found.broken || place_ == last_place ? 0 : place_ + 1;
    } else if (is_ready_) {
      is_ready_ = false;
      found.broken = !is_right || byte != 0x0F;
      place_ = found.broken ? 0 : 1;
      put_ = never;
    }
  }

  void unpack() noexcept {
    std::uint64_t bits = 0;
    std::uint32_t have = 0;
    std::size_t channel = 0;
    for (const std::uint32_t byte : bytes_) {
      bits |= std::uint64_t{byte} << have;
      have += 8;
      if (have >= 11) {
        values_[channel++] = static_cast<std::uint32_t>(bits & 0x7FFu) * 5 + lowest;
        bits >>= 11;
        have -= 11;
      }
    }
  }

  Tick tick_;
  UartReceiver receiver_;
  bool inverted_;
  std::array<std::uint32_t, 22> bytes_{};
  std::uint32_t place_ = 0;  // of the next byte; 0: not in a frame
  bool is_ready_ = false;    // a pause is over
  Clock came_ = never;       // the edge that takes a character
  Clock paused_;             // the edge that sees the end of a pause
  Clock put_ = never;        // the edge that stores the first channel
};

}  // namespace unitylink::device
