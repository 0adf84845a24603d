// SPDX-License-Identifier: BSD-3-Clause
#include "device/component/i2c_registers.hpp"

namespace unitylink::device {

I2cRegisters::I2cRegisters(Pins& pins, std::uint32_t component, const I2cLines& lines, Clock now)
    : pins_(pins), component_(component), lines_(lines) {
  pins.output(component, lines.sda_drive, now)->watch([this](bool level, Clock state) { data(!level, state); });
  pins.output(component, lines.scl_drive, now)->watch([this](bool level, Clock state) { clock(!level, state); });
}

// A change while scl is high: a start, or a stop.
void I2cRegisters::data(bool level, Clock state) {
  sda_ = level;
  if (!scl_) {
    data_from_ = state;
    return;
  }
  lasted(level ? "stop_setup" : "start_setup", scl_from_, state);
  if (level) {
    stop_from_ = state;
  } else {
    lasted("bus_free", stop_from_, state);
    stop_from_ = never;
    start_from_ = state;
  }
  phase_ = level || !plugged ? Phase::idle : Phase::address;
  fresh_ = true;
  bits_ = 0;
  show(true, state);
}

void I2cRegisters::clock(bool level, Clock state) {
  scl_ = level;
  lasted(level ? "scl_low" : "scl_high", scl_from_, state);
  lasted(level ? "data_setup" : "start_hold", level ? data_from_ : start_from_, state);
  data_from_ = never;
  start_from_ = never;
  scl_from_ = state;
  if (phase_ == Phase::idle) {
    return;
  }
  if (level) {
    if (bits_ < 8 && phase_ != Phase::read) {
      shifted_ = static_cast<std::uint8_t>(shifted_ << 1 | (sda_ ? 1 : 0));
    }
    refused_ = sda_;
    return;
  }
  if (fresh_) {
    fresh_ = false;
    return;
  }
  ++bits_;
  if (bits_ == 8) {
    byte_ended(state);
  } else if (bits_ == 9) {
    bits_ = 0;
    acknowledged(state);
  } else if (phase_ == Phase::read) {
    show((registers[place_] >> (7 - bits_) & 1u) != 0, state);
  }
}

// The next bit is the acknowledge: of the device, unless it sends.
void I2cRegisters::byte_ended(Clock state) {
  if (phase_ == Phase::address && shifted_ >> 1 != lines_.address) {
    phase_ = Phase::idle;
  }
  show(phase_ == Phase::idle || phase_ == Phase::read, state);
}

void I2cRegisters::acknowledged(Clock state) {
  show(true, state);
  switch (phase_) {
    case Phase::address: phase_ = (shifted_ & 1u) != 0 ? Phase::read : Phase::pointer; break;
    case Phase::pointer:
      place_ = static_cast<std::uint8_t>(shifted_ * lines_.width);
      phase_ = Phase::write;
      return;
    case Phase::write: registers[place_++] = shifted_; return;
    default:
      ++place_;
      if (refused_) {
        phase_ = Phase::idle;
      }
  }
  if (phase_ == Phase::read) {
    show((registers[place_] & 0x80u) != 0, state);
  }
}

// A clock later, so that no watcher of a pin changes pins.
void I2cRegisters::show(bool level, Clock state) { pins_.drive_at(component_, lines_.sda_in, level, state + 1); }

}  // namespace unitylink::device
