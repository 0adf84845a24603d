// SPDX-License-Identifier: BSD-3-Clause
// Silence for so many ticks of the base frequency, and the outputs become safe.
#pragma once

#include <algorithm>
#include <cstdint>

#include "device/clock.hpp"

namespace unitylink::device {

class DeadMan {
 public:
  explicit DeadMan(Clock period) noexcept : period_(period) {}

  [[nodiscard]] std::uint32_t ticks() const noexcept { return ticks_; }
  [[nodiscard]] bool running() const noexcept { return ticks_ > 0; }
  [[nodiscard]] bool tripped() const noexcept { return tripped_; }
  // It tripped in the session that is still open, which therefore may not arm.
  [[nodiscard]] bool tripped_in_session() const noexcept { return tripped_in_session_; }

  void begin_session() noexcept {
    ticks_ = 0;
    tripped_in_session_ = false;
    fed_at_ = never;
  }
  void set(std::uint32_t ticks, Clock now) noexcept {
    ticks_ = ticks;
    feed(now);
  }
  void arm() noexcept { tripped_ = false; }
  // An intact frame of the session came.
  void feed(Clock now) noexcept { fed_at_ = now; }
  void trip() noexcept {
    tripped_ = tripped_in_session_ = true;
    ticks_ = 0;
  }

  // The tick at which it trips if nothing comes.
  [[nodiscard]] Clock due() const noexcept { return running() ? (fed_at_ / period_ + ticks_) * period_ : never; }

 private:
  Clock period_;
  std::uint32_t ticks_ = 0;
  Clock fed_at_ = never;
  bool tripped_ = false;
  bool tripped_in_session_ = false;
};

}  // namespace unitylink::device
