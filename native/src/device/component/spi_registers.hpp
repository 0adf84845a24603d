// SPDX-License-Identifier: BSD-3-Clause
// A device on SPI, as most sensors are: the first byte of a frame is the number of a register, with bit 7 for a read.
// The further bytes are of this register and of those behind it.
#pragma once

#include <cstdint>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class SpiRegisters final : public BusDevice {
 public:
  // The lines must be pins of `component`.
  SpiRegisters(Pins& pins, std::uint32_t component, const SpiLines& lines, Clock now);

 private:
  void select(bool level, Clock state);
  void clock(bool level, Clock state);
  void heard();
  void show(Clock state);

  Pins& pins_;
  std::uint32_t component_;
  SpiLines lines_;
  const OutputPin* mosi_;
  bool selected_ = false;
  std::uint32_t bits_ = 0;  // of this frame
  std::uint8_t shifted_ = 0;
  std::uint8_t place_ = 0;
  bool reads_ = false;
};

}  // namespace unitylink::device
