// SPDX-License-Identifier: BSD-3-Clause
// The default plants of a board: words that count, and words that echo.
#pragma once

#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "device/board.hpp"

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

  void step(Board& board, double time_s) const {
    for (const Ramp& ramp : ramps_) {
      const double count = std::fmod(std::floor(time_s * ramp.pace_hz), ramp.span);
      board.set(ramp.address, static_cast<std::uint32_t>(ramp.low) + static_cast<std::uint32_t>(count));
    }
    for (const Echo& echo : echoes_) {
      if (const BusReply word = board.get(echo.from); word.status == BusStatus::ok) {
        board.set(echo.to, word.value);
      }
    }
  }

 private:
  std::vector<Ramp> ramps_;
  std::vector<Echo> echoes_;
};

}  // namespace unitylink::device
