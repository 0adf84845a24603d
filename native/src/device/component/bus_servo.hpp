// SPDX-License-Identifier: BSD-3-Clause
// A servo on a bus, with the protocol of Dynamixel (2.0) or of Feetech. Its registers are its control table: it takes
// writes to all servos at once (83), and answers questions to it (02). Register 255 is the error byte of its replies.
#pragma once

#include <cstdint>
#include <vector>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class BusServo final : public BusDevice {
 public:
  // The lines must be pins of `component`.
  BusServo(Pins& pins, std::uint32_t component, const ServoLines& lines, Clock now);

 private:
  void line(bool level, Clock state);
  void enable(bool level, Clock state);
  void read_until(double time);
  void heard(Clock ended);
  void write(std::size_t first);
  void answer(std::size_t first, Clock ended);

  Pins& pins_;
  std::uint32_t component_;
  ServoLines lines_;
  bool level_ = true;
  double begun_ = -1;        // when the start bit began; negative: the line rests
  std::uint32_t place_ = 0;  // of the next bit of the byte
  std::uint32_t byte_ = 0;
  std::vector<std::uint8_t> packet_;
};

}  // namespace unitylink::device
