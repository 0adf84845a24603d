// SPDX-License-Identifier: BSD-3-Clause
// The model of rc_receiver_ppm.vhd: the distances of edges are channels.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "device/component/input_filter.hpp"
#include "device/component/tick.hpp"
#include "rc_receiver_frame.hpp"

namespace unitylink::device {

class PpmFrames final : public RcFrames {
 public:
  PpmFrames(std::uint64_t clock_hz, std::uint32_t channels, bool inverted, std::uint32_t stable_clocks)
      : tick_(clock_hz, 8'000'000),
        filter_(1, stable_clocks),
        channels_(channels),
        inverted_(inverted),
        ends_(tick_.state_of(pause)) {}

  void drive(bool level, Clock edge) override { filter_.drive(0, level, edge); }
  [[nodiscard]] Clock next() const noexcept override { return std::min({filter_.next(), look_, ends_}); }

  RcFrame step(Clock edge) override {
    RcFrame found;
    const bool level = filter_.level(0);
    if (level != before_ && level != inverted_) {
      const std::uint64_t passed = (edge == 0 ? 0 : tick_.until(edge - 1)) - base_;
      if (in_frame_) {
        const bool fits = passed >= shortest && passed <= longest && count_ < channels_;
        wrong_ = wrong_ || !fits;
        if (fits) {
          values_[count_++] = static_cast<std::uint32_t>(passed);
          found.put = true;
        }
      } else if (may_begin_) {
        in_frame_ = true;
        wrong_ = false;
        count_ = 0;
      }
      base_ = tick_.until(edge);
      ends_ = tick_.state_of(base_ + pause);
    } else if (edge == ends_) {
      ends_ = never;
      found.whole = in_frame_ && !wrong_ && count_ == channels_;
      found.broken = in_frame_ && !found.whole;
      may_begin_ = true;
      in_frame_ = false;
    }
    before_ = level;
    look_ = filter_.step(edge) ? edge + 1 : never;
    return found;
  }

 private:
  static constexpr std::uint64_t shortest = 8 * 700;
  static constexpr std::uint64_t longest = 8 * 2300;
  static constexpr std::uint64_t pause = 8 * 2700;

  Tick tick_;
  InputFilter filter_;
  std::uint32_t channels_;
  bool inverted_;
  std::uint64_t base_ = 0;  // ticks until the last edge
  Clock ends_;              // the edge at which the pause is long enough
  Clock look_ = never;      // the edge that sees another level
  bool before_ = false;
  bool may_begin_ = false;
  bool in_frame_ = false;
  bool wrong_ = false;
  std::uint32_t count_ = 0;
};

}  // namespace unitylink::device
