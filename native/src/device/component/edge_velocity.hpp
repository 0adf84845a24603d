// SPDX-License-Identifier: BSD-3-Clause
// The model of quadrature_encoder_velocity.vhd: counts between two edges, over the time between them.
#pragma once

#include <algorithm>
#include <cstdint>

#include "device/clock.hpp"
#include "device/component/component_configuration.hpp"

namespace unitylink::device {

class EdgeVelocity {
 public:
  // `in_rounds`: it shares the words of quadrature_encoder_counts.vhd.
  EdgeVelocity(const ComponentConfiguration& from, std::int64_t window_us, std::int64_t stall_us, bool in_rounds = true)
      : in_rounds_(in_rounds),
        window_(clocks_of(window_us, from)),
        stall_(clocks_of(stall_us, from)),
        factor_(static_cast<std::uint64_t>(clock_hz(from)) * 256),
        speed_most_(from.data_mask() >> 1),
        tick_(window_ - 1) {
    const std::uint32_t way_bits = bits_for(window_ + 2);
    work_clocks_ = way_bits + way_bits + bits_for(static_cast<std::uint64_t>(clock_hz(from)) + 1) + 8 + 1;
  }

  // The velocity in 1/256 count/s.
  [[nodiscard]] std::int32_t value() const noexcept {
    const auto speed = static_cast<std::int32_t>(speed_);
    return back_ ? -speed : speed;
  }
  [[nodiscard]] Clock next() const noexcept {
    const Clock soonest = std::min(finish_, clear_);
    return rests_ ? soonest : std::min({soonest, tick_, stall_edge()});
  }
  // The edge of the clock, before those of the lines that come with it.
  void tick(Clock edge) noexcept {
    if (edge == finish_) {
      finish();
    }
    if (edge == clear_) {
      speed_ = 0;
      back_ = false;
      clear_ = never;
    }
    if (!rests_ && edge == tick_) {
      start(edge);
      tick_ += window_;
    }
  }
  // An edge of the lines.
  void moved(Clock edge, bool up) noexcept {
    if (rests_) {
      rests_ = false;
      begin_ = edge;
      way_ = 0;
      begins_up_ = up;
      tick_ = edge + window_ - edge % window_ - 1;
      if (tick_ == edge) {
        tick_ += window_;
      }
    } else {
      has_edge_ = true;
      way_ += up ? 1 : -1;
    }
    end_ = edge;
    ends_up_ = up;
  }
  // Has it rested for so long now that it is stopped?
  bool stalls(Clock edge, bool has_moved) noexcept {
    if (rests_ || has_moved || edge != stall_edge()) {
      return false;
    }
    rests_ = true;
    has_edge_ = false;
    finish_ = never;
    clear_ = free_edge(edge + 2);
    return true;
  }

 private:
  [[nodiscard]] static std::int64_t clock_hz(const ComponentConfiguration& from) noexcept {
    return from.generic("clock_hz", 50'000'000);
  }
  [[nodiscard]] static Clock clocks_of(std::int64_t time_us, const ComponentConfiguration& from) noexcept {
    const std::int64_t clock_khz = std::max<std::int64_t>(1, clock_hz(from) / 1000);
    return static_cast<Clock>(
        std::max<std::int64_t>(1, time_us / 1000 * clock_khz + time_us % 1000 * clock_khz / 1000));
  }
  [[nodiscard]] static std::uint32_t bits_for(std::uint64_t values) noexcept {
    std::uint32_t bits = 1;
    while ((std::uint64_t{1} << bits) < values) {
      ++bits;
    }
    return bits;
  }
  // The words take the velocity in three clocks of a round of 16, and then it must not change.
  [[nodiscard]] Clock free_edge(Clock edge) const noexcept {
    const Clock place = edge % 16;
    return in_rounds_ && place >= 12 && place <= 14 ? edge + 15 - place : edge;
  }
  [[nodiscard]] Clock stall_edge() const noexcept { return end_ + 1 + stall_; }

  void start(Clock edge) noexcept {
    is_bound_ = !has_edge_;
    std::int64_t way = 1;
    Clock span = edge - 1 - end_;
    turns_ = back_;
    if (has_edge_) {
      way = way_ + (begins_up_ ? 1 : 0) - (ends_up_ ? 1 : 0);
      span = end_ - begin_;
      turns_ = way < 0;
      begin_ = end_;
      begins_up_ = ends_up_;
      way_ = 0;
      has_edge_ = false;
    }
    const std::uint64_t product = static_cast<std::uint64_t>(way < 0 ? -way : way) * factor_;
    result_ = span == 0 ? speed_most_ : std::min(product / span, speed_most_);
    finish_ = free_edge(edge + work_clocks_);
  }

  void finish() noexcept {
    if (!is_bound_ || speed_ > result_) {
      speed_ = result_;
      back_ = turns_;
    }
    finish_ = never;
  }

  bool in_rounds_;
  Clock window_;
  Clock stall_;
  std::uint64_t factor_;
  std::uint64_t speed_most_;
  Clock work_clocks_ = 0;
  Clock tick_;              // the end of the window
  Clock finish_ = never;    // when the result is there
  Clock clear_ = never;     // when the velocity becomes 0, because it has stopped
  Clock begin_ = 0;         // of the way
  Clock end_ = 0;           // the last edge
  std::int64_t way_ = 0;    // counts between them
  bool begins_up_ = false;  // the direction of the first edge
  bool ends_up_ = false;    // that of the last one
  bool has_edge_ = false;
  bool rests_ = true;
  bool is_bound_ = false;  // the result is the most that the speed can be
  bool turns_ = false;
  bool back_ = false;
  std::uint64_t speed_ = 0;
  std::uint64_t result_ = 0;
};

}  // namespace unitylink::device
