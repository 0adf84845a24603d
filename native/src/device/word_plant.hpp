// SPDX-License-Identifier: BSD-3-Clause
// The default plants of a board: words that count, and words that echo.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "device/served_device.hpp"

namespace unitylink::device {

// Counts from `low` over `span` values, `pace_hz` of them a second, then from `low` again.
struct Ramp {
  std::uint32_t address = 0;
  std::int32_t low = 0;
  std::uint32_t span = 1;
  double pace_hz = 1;
};

// `to` follows what the PC wrote to `from`.
struct Echo {
  std::uint32_t from = 0;
  std::uint32_t to = 0;
};

class WordPlant {
 public:
  WordPlant(std::vector<Ramp> ramps, std::vector<Echo> echoes) : ramps_(std::move(ramps)), echoes_(std::move(echoes)) {}

  void step(ServedDevice& device, double time_s) const {
    for (const Ramp& ramp : ramps_) {
      const double count = std::fmod(std::floor(time_s * ramp.pace_hz), ramp.span);
      device.set(ramp.address, static_cast<std::uint32_t>(ramp.low) + static_cast<std::uint32_t>(count));
    }
    for (const Echo& echo : echoes_) {
      if (const BusReply word = device.get(echo.from); word.status == BusStatus::ok) {
        device.set(echo.to, word.value);
      }
    }
  }

  // ServedDevice::settles() of all its words.
  [[nodiscard]] Clock settles(const ServedDevice& device) const noexcept {
    Clock longest = 0;
    for (const Ramp& ramp : ramps_) {
      longest = std::max(longest, device.settles(ramp.address));
    }
    for (const Echo& echo : echoes_) {
      longest = std::max({longest, device.settles(echo.from), device.settles(echo.to)});
    }
    return longest;
  }

 private:
  std::vector<Ramp> ramps_;
  std::vector<Echo> echoes_;
};

}  // namespace unitylink::device
