// SPDX-License-Identifier: BSD-3-Clause
// The outside of a board's components: what plants drive, and what they see.
#include <algorithm>
#include <cmath>

#include "device/board.hpp"

namespace unitylink::device {

bool Board::drive(std::uint32_t component, std::uint32_t pin, bool level) {
  const auto lock = enter();
  const bool found = device_->pins().drive(component, pin, level, device_->clock());
  wake();
  return found;
}

bool Board::turn(std::uint32_t component, const EncoderLines& lines, std::int64_t counts, double seconds) {
  const auto lock = enter();
  const Clock now = device_->clock();
  const auto duration = static_cast<Clock>(std::llround(seconds * configuration().clock_hz));
  const bool found = device_->pins().turn(component, lines, counts, now, now + duration);
  wake();
  return found;
}

bool Board::modulate(std::uint32_t component, const ModulatorLines& lines, double level, double seconds) {
  const auto lock = enter();
  const Clock now = device_->clock();
  const auto duration = static_cast<Clock>(std::llround(seconds * configuration().clock_hz));
  const auto input = std::llround(std::clamp(level, -1.0, 1.0) * static_cast<double>(Modulator::full));
  return device_->pins().modulate(component, lines, input, now, now + duration);
}

bool Board::attach(std::uint32_t component, const DeviceLines& lines) {
  const auto lock = enter();
  const bool found = device_->pins().attach(component, lines, device_->clock()) != nullptr;
  wake();
  return found;
}

bool Board::with_device(std::uint32_t component, std::uint32_t out, const std::function<void(BusDevice&)>& use) {
  const auto lock = enter();
  BusDevice* found = device_->pins().attached(component, out);
  if (found != nullptr) {
    use(*found);
  }
  return found != nullptr;
}

bool Board::count_by(std::uint32_t component, std::uint32_t pin, std::uint32_t direction) {
  const auto lock = enter();
  OutputPin* counted = device_->pins().output(component, pin, device_->clock());
  const OutputPin* chosen = device_->pins().output(component, direction, device_->clock());
  if (counted == nullptr || chosen == nullptr) {
    return false;
  }
  counted->count_by(chosen);
  return true;
}

void Board::play(std::uint32_t component, std::uint32_t pin, const PinLevels& levels) {
  const auto lock = enter();
  std::vector<PinChange> changes;
  for (const auto& [seconds, level] : levels) {
    changes.push_back({static_cast<Clock>(std::llround(seconds * configuration().clock_hz)), level});
  }
  device_->pins().play(component, pin, changes, device_->clock());
  wake();
}

std::optional<Board::PinLevels> Board::edges(std::uint32_t component, std::uint32_t pin) {
  const auto lock = enter();
  const auto found = device_->pins().take_edges(component, pin, device_->clock());
  wake();  // somebody watches the pin from now on
  if (!found) {
    return std::nullopt;
  }
  PinLevels levels;
  for (const PinChange& one : *found) {
    levels.emplace_back(static_cast<double>(one.at) / configuration().clock_hz, one.level);
  }
  return levels;
}

std::optional<SeenPin> Board::look(std::uint32_t component, std::uint32_t pin) {
  const auto lock = enter();
  const Clock now = device_->clock();
  const OutputPin* found = device_->pins().output(component, pin, now);
  if (found == nullptr) {
    return std::nullopt;
  }
  const auto seconds = [this](Clock clock) { return static_cast<double>(clock) / configuration().clock_hz; };
  return SeenPin{found->level(), found->rises(), found->steps(), seconds(found->high_clocks(now)), seconds(now)};
}

}  // namespace unitylink::device
