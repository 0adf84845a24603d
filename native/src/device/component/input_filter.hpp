// SPDX-License-Identifier: BSD-3-Clause
// The model of input_filter.vhd: a synchroniser of two flip-flops, then a level counts when it has been stable.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "device/clock.hpp"

namespace unitylink::device {

class InputFilter {
 public:
  InputFilter(std::uint32_t width, std::uint32_t stable_clocks) : pins_(width), stable_clocks_(stable_clocks) {}

  // Clocks that last at least so long: clocks_lasting of rate_pkg.vhd.
  [[nodiscard]] static std::uint32_t lasting(std::int64_t time_ns, std::int64_t clock_hz) noexcept {
    const std::int64_t clock_khz = (clock_hz + 999) / 1000;
    return static_cast<std::uint32_t>(std::max<std::int64_t>(1, (time_ns * clock_khz + 999'999) / 1'000'000));
  }

  // Edge `edge` is the first to sample `level`. Calls come in the order of time.
  void drive(std::uint32_t pin, bool level, Clock edge) noexcept {
    Pin& one = pins_[pin];
    if (one.waiting > 0 && one.changes[one.waiting - 1].edge == edge + 1) {
      one.changes[one.waiting - 1].level = level;  // no edge has seen the level before
    } else if (level != one.last) {
      one.changes[one.waiting++] = {edge + 1, level};  // the second flip-flop takes it one edge later
    }
    one.last = level;
    soonest_ = std::min(soonest_, edge + 1);
  }

  // The next edge at which a flip-flop behind the pins may change. It may be too early, never too late.
  [[nodiscard]] Clock next() const noexcept { return soonest_; }

  // Edge `edge` happens. True: a level has changed.
  bool step(Clock edge) noexcept {
    if (edge < soonest_) {
      return false;
    }
    bool changed = false;
    soonest_ = never;
    for (Pin& one : pins_) {
      if (one.differs_from != never && edge >= one.differs_from + stable_clocks_ - 1) {
        one.level = !one.level;
        one.differs_from = never;
        changed = true;
      }
      if (one.waiting > 0 && one.changes[0].edge <= edge) {
        one.settled = one.changes[0].level;
        std::copy(one.changes.begin() + 1, one.changes.begin() + one.waiting, one.changes.begin());
        --one.waiting;
        one.differs_from = one.settled == one.level ? never : edge + 1;
      }
      if (one.differs_from != never) {
        soonest_ = std::min(soonest_, one.differs_from + stable_clocks_ - 1);
      }
      if (one.waiting > 0) {
        soonest_ = std::min(soonest_, one.changes[0].edge);
      }
    }
    return changed;
  }

  [[nodiscard]] bool level(std::uint32_t pin) const noexcept { return pins_[pin].level; }
  [[nodiscard]] std::uint32_t levels() const noexcept {
    std::uint32_t bits = 0;
    for (std::uint32_t pin = 0; pin < pins_.size(); ++pin) {
      bits |= static_cast<std::uint32_t>(pins_[pin].level) << pin;
    }
    return bits;
  }

 private:
  struct Change {
    Clock edge = 0;  // at which the second flip-flop takes it
    bool level = false;
  };
  struct Pin {
    std::array<Change, 4> changes{};  // at most two are under way, and one more has just come
    std::uint32_t waiting = 0;
    bool last = false;     // on the pin
    bool settled = false;  // behind the synchroniser
    bool level = false;
    Clock differs_from = never;  // the first edge that sees `settled` differ from `level`
  };

  std::vector<Pin> pins_;
  std::uint32_t stable_clocks_;
  Clock soonest_ = never;
};

}  // namespace unitylink::device
