// SPDX-License-Identifier: BSD-3-Clause
// A train of steps: those of one axis in many base periods of one velocity. One computation for each step.
#pragma once

#include <cstdint>

#include "stepgen_periods.hpp"

namespace unitylink::device {

// What a velocity does to the phase in each base period.
struct StepgenWay {
  explicit StepgenWay(std::uint32_t word) noexcept
      : velocity(word), speed(word >> 31 != 0 ? 0u - word : word), down(word >> 31 != 0) {}

  std::uint32_t velocity, speed;
  bool down;

  // The base periods before the one that asks for a step, from the phase `at`. Not at rest.
  [[nodiscard]] std::uint32_t periods_before_step(std::uint32_t at, std::uint32_t mask) const noexcept {
    return (down ? at : mask - at) / speed;
  }
};

struct StepgenTrain {
  StepgenWay way;
  std::uint32_t mask;  // of a phase
  std::uint32_t at;    // the word of the phase, with carry or borrow
  std::uint32_t steps = 0;
  bool ends_with_step = false;  // in the last base period

  // Each step must be one that `pulse` takes at once. `asks_at`: the clock of a base period that asks for it. Calls
  // tell(level, clocks): STEP changes in the clock after so many.
  template <typename Tell>
  void play(StepgenPulse& pulse, const StepgenPeriods& lengths, std::uint64_t periods, std::uint32_t asks_at,
            const Tell& tell) {
    std::uint64_t done = 0;
    Clock fall = pulse.clocks_to_fall();
    Clock pulsed = 0;  // the clocks that the pulse has done
    while (way.speed != 0) {
      const std::uint64_t more = way.periods_before_step(at & mask, mask) + std::uint64_t{1};
      if (done + more > periods) {
        break;
      }
      go(more);
      done += more;
      const Clock rise = lengths.clocks_of(done - 1) + asks_at;
      if (fall != never) {
        tell(false, fall);
      }
      tell(true, rise);
      fall = rise + pulse.length_clocks();
      pulsed = rise + 1;
      ++steps;
    }
    ends_with_step = steps > 0 && done == periods;
    if (done < periods) {
      go(periods - done);
    }
    if (steps > 0) {
      pulse.begin();
    }
    const Clock clocks = lengths.clocks_of(periods);
    pulse.skip(clocks - pulsed);
    if (fall < clocks) {
      tell(false, fall);
    }
  }

 private:
  void go(std::uint64_t periods) noexcept { at = (at & mask) + static_cast<std::uint32_t>(periods) * way.velocity; }
};

}  // namespace unitylink::device
