// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/speed_controller.hpp"

#include <array>

namespace unitylink::device {

namespace {

constexpr std::uint32_t frame_bits = 16;
constexpr std::array<std::uint8_t, 16> codes{0x19, 0x1B, 0x12, 0x13, 0x1D, 0x15, 0x16, 0x17,
                                             0x1A, 0x09, 0x0A, 0x0B, 0x1E, 0x0D, 0x0E, 0x0F};

std::uint32_t sum_of(std::uint32_t twelve) noexcept { return (twelve >> 8 ^ twelve >> 4 ^ twelve) & 0xFu; }

}  // namespace

SpeedController::SpeedController(Pins& pins, std::uint32_t component, const EscLines& lines, Clock now)
    : pins_(pins), component_(component), lines_(lines) {
  registers[8] = 0xFF;  // it stands
  registers[9] = 0x0F;
  pins.output(component, lines.out, now)->watch([this](bool level, Clock state) {
    edge(level != lines_.replies, state);
  });
}

void SpeedController::edge(bool active, Clock state) {
  const auto passed = static_cast<double>(state - rose_);
  if (active) {
    if (passed > 2 * lines_.bit) {
      bits_ = 0;  // a pause: a new frame
      data_ = 0;
    }
    rose_ = state;
    return;
  }
  data_ = data_ << 1 | (passed > lines_.bit * 9 / 16 ? 1u : 0u);
  if (++bits_ == frame_bits) {
    heard();
  }
}

void SpeedController::heard() {
  const std::uint32_t sum = sum_of(data_ >> 4 & 0xFFFu) ^ (lines_.replies ? 0xFu : 0u);
  if (!plugged || sum != (data_ & 0xFu)) {
    return;
  }
  registers[0] = static_cast<std::uint8_t>(data_ >> 5);
  registers[1] = static_cast<std::uint8_t>(data_ >> 13 & 0x7u);
  registers[2] = static_cast<std::uint8_t>(data_ >> 4 & 1u);
  ++registers[3];
  if (lines_.replies) {
    reply();
  }
}

void SpeedController::reply() {
  const std::uint32_t period = registers[8] | (registers[9] & 0xFu) << 8;
  const std::uint32_t data = period << 4 | (sum_of(period) ^ 0xFu);
  std::uint32_t code = 1;  // the start bit
  for (const std::uint32_t place : {12u, 8u, 4u, 0u}) {
    code = code << 5 | codes[data >> place & 0xFu];
  }
  const double length = lines_.bit * 4 / 5;
  const double start = static_cast<double>(rose_) + lines_.bit + lines_.answer;
  bool level = true;
  for (int place = 20; place >= 0; --place) {
    if ((code >> place & 1u) != 0) {
      level = !level;
      pins_.drive_at(component_, lines_.in, level, static_cast<Clock>(start + (20 - place) * length));
    }
  }
  pins_.drive_at(component_, lines_.in, true, static_cast<Clock>(start + 21 * length));
}

}  // namespace unitylink::device
