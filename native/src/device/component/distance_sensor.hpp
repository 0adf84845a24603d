// SPDX-License-Identifier: BSD-3-Clause
// An ultrasonic distance sensor at the lines of `sonar`, such as the HC-SR04.
//
// Its registers 0 to 3 are the length of its echo in us, low byte first. 0: nothing reflects, and the echo is 38 ms.
// 4 counts triggers.
#pragma once

#include <cstdint>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class DistanceSensor final : public BusDevice {
 public:
  // The lines must be pins of `component`.
  DistanceSensor(Pins& pins, std::uint32_t component, const DistanceLines& lines, Clock now);

 private:
  void edge(bool level, Clock state);

  Pins& pins_;
  std::uint32_t component_;
  DistanceLines lines_;
  Clock rose_ = never;  // when the last trigger began
  Clock rests_ = 0;     // from then on it can be triggered
};

}  // namespace unitylink::device
