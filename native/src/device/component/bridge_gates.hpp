// SPDX-License-Identifier: BSD-3-Clause
// The model of bridge_gates.vhd: dead time, enable and fault of some half bridges.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "device/clock.hpp"
#include "device/component/component_configuration.hpp"

namespace unitylink::device {

class BridgeGates {
 public:
  BridgeGates(const ComponentConfiguration& from, std::uint32_t legs)
      : legs_(legs),
        clock_ns_(static_cast<std::uint32_t>(1'000'000'000 / from.generic("clock_hz", 50'000'000))),
        dead_least_(static_cast<std::uint32_t>(from.generic("dead_minimum_ns", 500))),
        fault_level_(from.generic("fault_level", 1) != 0),
        first_(!fault_level_),
        second_(!fault_level_),
        dead_(dead_least_) {
    take_dead(0);
  }

  // The next edge has this level on the pin `fault`.
  void drive(bool level) noexcept { pin_ = level; }

  // The next edge at which something changes by itself. It may be too early, never too late.
  [[nodiscard]] Clock next() const noexcept { return pin_ != first_ || first_ != second_ ? 0 : next_; }

  // This dead time counts for those that begin from now on. Its clocks are those of the longest time in its 8 ns.
  void take_dead(std::uint32_t dead) noexcept {
    dead_ = std::max(dead & 0xFFFu, dead_least_);
    dead_clocks_ = std::max<Clock>(1, ((dead_ | 7u) + clock_ns_ - 1) / clock_ns_);
  }

  // Edge `edge` happens. The arguments are of the state before it, as in the VHDL.
  void step(Clock edge, bool enable, std::uint32_t driven, std::uint32_t sides, bool hold = false) {
    const bool was_seen = seen();
    const bool was_running = running_;
    trip_ = was_seen && !tripped_;
    if (was_seen) {
      running_ = false;
      tripped_ = true;
    } else if (!enable) {
      running_ = false;
    } else if (!enabled_before_) {
      running_ = true;
      tripped_ = false;
    }
    bool changes = trip_ || running_ != was_running || enabled_before_ != enable;
    next_ = never;
    for (std::uint32_t number = 0; number < legs_.size(); ++number) {
      Leg& leg = legs_[number];
      const bool side = (sides >> number & 1u) != 0;
      if (!was_running || was_seen || (driven >> number & 1u) == 0 || (side != leg.side && !hold)) {
        changes = changes || leg.high || leg.low || side != leg.side;
        leg = {side, false, false, edge + dead_clocks_};
      } else if (!leg.high && !leg.low) {
        if (edge >= leg.ends) {
          leg.high = leg.side;
          leg.low = !leg.side;
          changes = true;
        } else {
          next_ = std::min(next_, leg.ends);
        }
      }
    }
    enabled_before_ = enable;
    second_ = first_;
    first_ = pin_;
    if (changes || seen() != was_seen) {
      next_ = edge + 1;
    }
  }

  // The state behind the last edge.
  [[nodiscard]] bool running() const noexcept { return running_; }
  [[nodiscard]] bool tripped() const noexcept { return tripped_; }
  [[nodiscard]] bool trip() const noexcept { return trip_; }
  [[nodiscard]] bool seen() const noexcept { return second_ == fault_level_; }
  [[nodiscard]] std::uint32_t dead_used() const noexcept { return dead_; }
  [[nodiscard]] bool high(std::uint32_t leg) const noexcept { return legs_[leg].high && !seen(); }
  [[nodiscard]] bool low(std::uint32_t leg) const noexcept { return legs_[leg].low && !seen(); }
  [[nodiscard]] std::uint32_t status() const noexcept {
    return static_cast<std::uint32_t>(running_) | static_cast<std::uint32_t>(tripped_) << 1 |
           static_cast<std::uint32_t>(seen()) << 2;
  }

 private:
  struct Leg {
    bool side = false;
    bool high = false;
    bool low = false;
    Clock ends = 0;  // the edge that may switch a gate on
  };

  std::vector<Leg> legs_;
  std::uint32_t clock_ns_;
  std::uint32_t dead_least_;
  bool fault_level_;
  bool pin_ = false;
  bool first_;  // of the synchroniser
  bool second_;
  bool enabled_before_ = true;
  bool running_ = false;
  bool tripped_ = false;
  bool trip_ = false;
  std::uint32_t dead_;
  Clock dead_clocks_ = 1;
  Clock next_ = 0;
};

}  // namespace unitylink::device
