// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/thermometer.hpp"

#include <algorithm>
#include <array>

namespace unitylink::device {

namespace {

constexpr double reset_us = 480;
constexpr double one_us = 15;  // a longer low is a zero
constexpr std::size_t temperature = 16, clocks = 18, restarts = 22, presences = 23;
constexpr std::uint32_t scratchpad_bytes = 9;
constexpr std::array<std::uint8_t, 8> power_up{0x50, 0x05, 0x4B, 0x46, 0x7F, 0xFF, 0x0C, 0x10};

}  // namespace

Thermometer::Thermometer(Pins& pins, std::uint32_t component, const ThermometerLines& lines, Clock now)
    : pins_(pins),
      component_(component),
      lines_(lines),
      out_(pins.output(component, lines.out(), now)),
      drive_(pins.output(component, lines.drive, now)) {
  restart();
  for (const std::uint32_t pin : {lines.out(), lines.drive}) {
    pins.output(component, pin, now)->watch([this](bool, Clock state) { edge(state); });
  }
}

void Thermometer::restart() noexcept {
  std::copy(power_up.begin(), power_up.end(), registers.begin());
  state_ = State::idle;
  ready_ = 0;
}

// The strong pull-up drives the line high, so it is no low.
void Thermometer::edge(Clock state) {
  const bool low = drive_->level() && !out_->level();
  if (low == low_) {
    return;
  }
  low_ = low;
  if (!plugged || registers[restarts] != 0) {
    registers[restarts] = 0;
    restart();
  }
  if (low) {
    falls(state);
  } else {
    rises(state);
  }
}

void Thermometer::pull(double after_us, double until_us, Clock from) {
  pins_.drive_at(component_, lines_.in, false, from + static_cast<Clock>(after_us * lines_.us));
  pins_.drive_at(component_, lines_.in, true, from + static_cast<Clock>(until_us * lines_.us));
}

void Thermometer::falls(Clock state) {
  fell_ = state;
  if ((state_ == State::converting || state_ == State::reading) && !next_bit(state)) {
    pull(0, 30, state);
  }
}

void Thermometer::rises(Clock state) {
  const auto low_us = static_cast<double>(state - fell_) / lines_.us;
  if (low_us < reset_us) {
    hear(low_us <= one_us, state);
    return;
  }
  bits_ = 0;
  state_ = State::idle;
  if (plugged) {
    state_ = State::rom;
    ++registers[presences];
    pull(30, 150, state);
  }
}

bool Thermometer::next_bit(Clock state) {
  if (state_ == State::converting) {
    if (state < ready_) {
      return false;
    }
    finish();
    return true;
  }
  if (bits_ >= 8 * scratchpad_bytes) {
    return true;
  }
  const std::uint32_t byte = bits_ / 8;
  const std::uint8_t sent = byte < power_up.size() ? registers[byte] : check();
  return (sent >> (bits_ % 8) & 1u) != 0;
}

void Thermometer::hear(bool bit, Clock state) {
  ++bits_;
  if (state_ != State::rom && state_ != State::command && state_ != State::writing) {
    return;
  }
  shift_ = (shift_ >> 1 | (bit ? 0x80u : 0u)) & 0xFFu;
  if (bits_ % 8 != 0) {
    return;
  }
  if (state_ != State::writing) {
    obey(state);
  } else if (bits_ / 8 <= 3) {
    registers[1 + bits_ / 8] = static_cast<std::uint8_t>(shift_);
  }
}

void Thermometer::obey(Clock state) {
  bits_ = 0;
  if (state_ == State::rom) {
    state_ = shift_ == 0xCC ? State::command : State::idle;
    return;
  }
  switch (shift_) {
    case 0x4E: state_ = State::writing; break;
    case 0x44:
      state_ = State::converting;
      ready_ = state + number(clocks, 4);
      break;
    case 0xBE:
      if (state >= ready_ && ready_ != 0) {  // also if nobody has asked whether it is done
        finish();
      }
      state_ = State::reading;
      break;
    default: state_ = State::idle;
  }
}

// What was converted goes to the scratchpad.
void Thermometer::finish() noexcept {
  registers[0] = registers[temperature];
  registers[1] = registers[temperature + 1];
}

std::uint8_t Thermometer::check() const noexcept {
  std::uint8_t crc = 0;
  for (std::size_t byte = 0; byte < power_up.size(); ++byte) {
    for (std::uint32_t bit = 0; bit < 8; ++bit) {
      const bool topples = ((crc ^ registers[byte] >> bit) & 1u) != 0;
      crc = static_cast<std::uint8_t>(crc >> 1 ^ (topples ? 0x8Cu : 0u));
    }
  }
  return crc;
}

}  // namespace unitylink::device
