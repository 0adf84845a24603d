// SPDX-License-Identifier: BSD-3-Clause
// The base periods of stepgen_motion.vhd: as many a second as said, so some are a clock longer than the others.
#pragma once

#include <cstdint>
#include <numeric>

#include "stepgen_pulse.hpp"

namespace unitylink::device {

class StepgenPeriods {
 public:
  explicit StepgenPeriods(const StepgenRates& rates) {
    std::uint32_t common = 0;
    while (common < rates.base_bits && (rates.clock_hz >> common) % 2 == 0) {
      ++common;
    }
    gain_bits_ = rates.base_bits - common;
    gain_ = std::int64_t{1} << gain_bits_;
    loss_ = rates.clock_hz >> common;
    owed_ = gain_ - loss_;
  }

  bool operator==(const StepgenPeriods&) const = default;

  // Does one end with this clock?
  [[nodiscard]] bool ends() const noexcept { return owed_ >= 0; }
  void clock() noexcept { owed_ += ends() ? gain_ - loss_ : gain_; }

  // The clocks of `periods` from the first clock of one on.
  [[nodiscard]] Clock clocks_of(std::uint64_t periods) const noexcept {
    if (periods == 0) {
      return 0;
    }
    return static_cast<Clock>((loss_ * static_cast<std::int64_t>(periods - 1) - owed_ + gain_ - 1) >> gain_bits_) + 1;
  }
  void skip(std::uint64_t periods) noexcept {
    owed_ += gain_ * static_cast<std::int64_t>(clocks_of(periods)) - loss_ * static_cast<std::int64_t>(periods);
  }
  // The clocks after which so many, again and again, have the same lengths.
  [[nodiscard]] Clock cycle_clocks(std::uint32_t periods) const noexcept {
    return static_cast<Clock>(loss_) * (periods / std::gcd(static_cast<std::uint32_t>(gain_), periods));
  }

 private:
  std::uint32_t gain_bits_ = 0;
  std::int64_t gain_ = 1, loss_ = 1, owed_ = 0;
};

}  // namespace unitylink::device
