// SPDX-License-Identifier: BSD-3-Clause
// The model of sample_state.vhd: whether the value of a sensor may be used, and what went wrong.
#pragma once

#include <algorithm>
#include <cstdint>

#include "device/component/component_configuration.hpp"

namespace unitylink::device {

class SampleState {
 public:
  explicit SampleState(const ComponentConfiguration& from)
      : failures_most_(static_cast<std::uint32_t>(from.generic("failures_most", 3))) {}

  // A try has ended with this reason. 0 is a sample.
  void take(std::uint32_t reason) noexcept {
    last_ = reason;
    if (reason == 0) {
      in_a_row_ = 0;
      valid_ = true;
      return;
    }
    failures_ = (failures_ + 1) & 0xFFu;
    valid_ = valid_ && in_a_row_ != failures_most_ - 1;
    in_a_row_ = std::min(in_a_row_ + 1, 15u);
  }
  // The value counts no more.
  void make_void() noexcept { valid_ = false; }

  [[nodiscard]] bool is_valid() const noexcept { return valid_; }
  [[nodiscard]] std::uint32_t word() const noexcept {
    return (valid_ ? 0x8000u : 0u) | last_ << 12 | in_a_row_ << 8 | failures_;
  }

 private:
  std::uint32_t failures_most_;
  std::uint32_t last_ = 0;
  std::uint32_t in_a_row_ = 0;
  std::uint32_t failures_ = 0;
  bool valid_ = false;
};

}  // namespace unitylink::device
