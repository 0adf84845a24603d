// SPDX-License-Identifier: BSD-3-Clause
// A load cell behind an HX711 at the lines of `hx711`.
//
// Its registers 0 to 2, 4 to 6 and 8 to 10 are what it converts at its inputs A with 128, B, and A with 64, low byte
// first. 12 to 15 are the clocks of a conversion, and 16 counts those that were read.
#pragma once

#include <cstdint>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class LoadCell final : public BusDevice {
 public:
  // The lines must be pins of `component`.
  LoadCell(Pins& pins, std::uint32_t component, const LoadCellLines& lines, Clock now);

 private:
  void edge(bool level, Clock state);
  void convert(Clock from, std::uint32_t conversions);

  Pins& pins_;
  std::uint32_t component_;
  LoadCellLines lines_;
  Clock rose_ = never;         // when the last pulse began
  Clock ready_ = never;        // the next conversion
  std::uint32_t pulses_ = 25;  // of this one; more than 24 say that it was read
  std::uint32_t input_ = 0;
  std::uint32_t shift_ = 0;
};

}  // namespace unitylink::device
