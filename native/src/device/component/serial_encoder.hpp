// SPDX-License-Identifier: BSD-3-Clause
// An absolute encoder at the lines of `absolute_encoder`: SSI, BiSS-C, or an AS5047P and its family on SPI.
//
// Its registers 0 to 3 are what it measures, low byte first. In 4, bit 0 lets it report an error, and bit 1 a warning
// (BiSS-C has one). 5 counts frames.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class SerialEncoder final : public BusDevice {
 public:
  // The lines must be pins of `component`.
  SerialEncoder(Pins& pins, std::uint32_t component, const SerialEncoderLines& lines, Clock now);

 private:
  using Kind = SerialEncoderLines::Kind;

  void clock(bool level, Clock state);
  void latch(Clock state);
  void show_next(Clock state);
  void select(bool level, Clock state);
  void clock_chip(bool level, Clock state);
  void obey();
  void add(std::uint32_t word, std::uint32_t bits);
  void add_check();

  Pins& pins_;
  std::uint32_t component_;
  SerialEncoderLines lines_;
  const OutputPin* mosi_;
  std::vector<bool> frame_;  // what is shown, a bit at each rise of the clock
  std::size_t place_ = 0;
  Clock edge_ = never;  // the last one of the clock
  Clock rose_ = 0;
  bool selected_ = false;
  bool error_ = false;  // it stays until it is cleared
  std::uint32_t heard_ = 0;
  std::uint32_t heard_bits_ = 0;
  std::uint32_t reply_ = 0;  // of the next frame
};

}  // namespace unitylink::device
