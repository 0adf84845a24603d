// SPDX-License-Identifier: BSD-3-Clause
// The device's own registers: its description, its counters and its time.
#pragma once

#include <array>
#include <cstdint>

#include "device/clock.hpp"
#include "device/configuration.hpp"

namespace unitylink::device {

class ControlRegisters {
 public:
  static constexpr std::uint32_t counters_first = protocol::control::frames;
  static constexpr std::uint32_t counters_last = protocol::control::deadman_trips;

  explicit ControlRegisters(const DeviceConfiguration& configuration) noexcept : configuration_(configuration) {}

  // A counter stops at its highest value.
  void count(std::uint32_t counter) noexcept {
    std::uint32_t& value = counters_[counter - counters_first];
    value += value == 0xFFFFFFFFu ? 0u : 1u;
  }
  [[nodiscard]] std::uint32_t counter(std::uint32_t address) const noexcept {
    return counters_[address - counters_first];
  }

  [[nodiscard]] static constexpr bool has(std::uint32_t first, std::uint32_t count) noexcept {
    const auto within = [first, count](std::uint32_t low, std::uint32_t high) {
      return first >= low && first <= high && count <= high - first + 1;
    };
    return within(protocol::control::magic, protocol::control::spec_hash_low) ||
           within(counters_first, counters_last) || within(protocol::control::time_low, protocol::control::publish);
  }

  // Description, counters and time. All others are in the application. A read of time_low stores the upper half.
  [[nodiscard]] std::uint32_t read(std::uint32_t address, Clock now) noexcept;

 private:
  const DeviceConfiguration& configuration_;
  std::array<std::uint32_t, counters_last - counters_first + 1> counters_{};
  std::uint32_t time_high_ = 0;
};

}  // namespace unitylink::device
