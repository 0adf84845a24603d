// SPDX-License-Identifier: BSD-3-Clause
// A speed controller with DShot, which answers with its speed if it is bidirectional.
//
// Its registers: 0 and 1 are the last value that it heard, low byte first, and 2 is its telemetry bit. 3 counts frames.
// 8 and 9 are what it sends: 3 bits of an exponent and 9 of a mantissa of a period in us, low byte first.
#pragma once

#include <cstdint>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class SpeedController final : public BusDevice {
 public:
  // The lines must be pins of `component`.
  SpeedController(Pins& pins, std::uint32_t component, const EscLines& lines, Clock now);

 private:
  void edge(bool active, Clock state);
  void heard();
  void reply();

  Pins& pins_;
  std::uint32_t component_;
  EscLines lines_;
  Clock rose_ = 0;  // when the last bit began
  std::uint32_t bits_ = 0;
  std::uint32_t data_ = 0;
};

}  // namespace unitylink::device
