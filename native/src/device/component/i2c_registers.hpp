// SPDX-License-Identifier: BSD-3-Clause
// A device on I2C, as most sensors are: behind its address comes the number of a register. The further bytes are of
// this register and of those behind it. With `width` 2 a register has two bytes, the high one first.
#pragma once

#include <cstdint>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class I2cRegisters final : public BusDevice {
 public:
  // The lines must be pins of `component`.
  I2cRegisters(Pins& pins, std::uint32_t component, const I2cLines& lines, Clock now);

 private:
  enum class Phase { idle, address, pointer, write, read };

  void data(bool level, Clock state);
  void clock(bool level, Clock state);
  void byte_ended(Clock state);
  void acknowledged(Clock state);
  void show(bool level, Clock state);

  Pins& pins_;
  std::uint32_t component_;
  I2cLines lines_;
  bool scl_ = true;
  bool sda_ = true;  // as the master has it
  bool fresh_ = false;
  Clock scl_from_ = never;    // when scl has changed
  Clock stop_from_ = never;   // the last stop
  Clock start_from_ = never;  // the last start, until scl falls
  Clock data_from_ = never;   // the last change of sda while scl is low
  bool refused_ = false;      // the master wants no further byte
  Phase phase_ = Phase::idle;
  std::uint32_t bits_ = 0;
  std::uint8_t shifted_ = 0;
  std::uint8_t place_ = 0;
};

}  // namespace unitylink::device
