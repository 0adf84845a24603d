// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/pins.hpp"

#include <algorithm>
#include <cstdlib>
#include <utility>

namespace unitylink::device {

// The clock of the next count. With more than one count a clock, the lines jump, as those of a shaft that is too fast.
Clock Pins::Shaft::next() const noexcept {
  if (counts == to) {
    return never;
  }
  const auto whole = static_cast<std::uint64_t>(std::llabs(to - from));
  const auto done = static_cast<std::uint64_t>(std::llabs(counts - from)) + 1;
  return begun + ((until - begun) * done + whole - 1) / whole;
}

std::int64_t Pins::Shaft::at(Clock now) const noexcept {
  if (now >= until) {
    return to;
  }
  const auto whole = static_cast<std::uint64_t>(std::llabs(to - from));
  const auto done = static_cast<std::int64_t>(whole * (now - begun) / (until - begun));
  return to < from ? from - done : from + done;
}

bool Pins::turn(std::uint32_t component, const EncoderLines& lines, std::int64_t counts, Clock now, Clock until) {
  advance_turns(now);
  const auto [place, is_new] = shafts_.try_emplace({component, lines});
  Shaft& shaft = place->second;
  if (is_new && !(drive(component, lines.a, false, now) && drive(component, lines.b, false, now))) {
    shafts_.erase(place);
    return false;
  }
  shaft.from = shaft.counts;
  shaft.to = counts;
  shaft.begun = now;
  shaft.until = std::max(until, now + 1);
  return true;
}

Clock Pins::next_turn() const noexcept {
  Clock soonest = never;
  for (const auto& [place, shaft] : shafts_) {
    soonest = std::min(soonest, shaft.next());
  }
  return soonest;
}

void Pins::advance_turns(Clock now) {
  for (auto& [place, shaft] : shafts_) {
    for (Clock next = shaft.next(); next <= now; next = shaft.next()) {
      shaft.counts = shaft.at(next);
      show(place.first, place.second, shaft.counts, next);
    }
  }
}

// a leads b when it counts up: 00, 10, 11, 01.
void Pins::show(std::uint32_t component, const EncoderLines& lines, std::int64_t counts, Clock at) {
  const auto quarter = static_cast<std::uint32_t>(counts & 3);
  drive(component, lines.a, quarter == 1 || quarter == 2, at);
  drive(component, lines.b, quarter >= 2, at);
  if (lines.per_turn > 0) {
    drive(component, lines.index, counts % lines.per_turn == 0, at);
  }
}

}  // namespace unitylink::device
