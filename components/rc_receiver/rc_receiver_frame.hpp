// SPDX-License-Identifier: BSD-3-Clause
// What the model of a front end of rc_receiver.vhd gives.
#pragma once

#include <array>
#include <cstdint>

#include "device/clock.hpp"

namespace unitylink::device {

// What comes of an edge. `whole` and `broken` show one state later than `put`.
struct RcFrame {
  bool put = false;  // a channel has come, so the frame before can be taken no more
  bool whole = false;
  bool broken = false;
};

class RcFrames {
 public:
  RcFrames() = default;
  RcFrames(const RcFrames&) = delete;
  RcFrames& operator=(const RcFrames&) = delete;
  virtual ~RcFrames() = default;

  // Edge `edge` is the first to sample this level of the line.
  virtual void drive(bool level, Clock edge) = 0;
  [[nodiscard]] virtual Clock next() const noexcept = 0;
  virtual RcFrame step(Clock edge) = 0;

  // The channels of the last whole frame, and its flags: failsafe, lost, switches 18 and 17.
  [[nodiscard]] const std::array<std::uint32_t, 16>& values() const noexcept { return values_; }
  [[nodiscard]] std::uint32_t flags() const noexcept { return flags_; }

 protected:
  std::array<std::uint32_t, 16> values_{};
  std::uint32_t flags_ = 0;
};

}  // namespace unitylink::device
