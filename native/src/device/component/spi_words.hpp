// SPDX-License-Identifier: BSD-3-Clause
// A device on SPI that sends one word a frame, and has no registers, as converters are: word n is in the registers 4 n
// to 4 n + 3, the high byte first. A thermocouple's converter sends its word 0 as soon as it is selected. A converter
// of several channels waits for a start bit and a number of four bits. Two edges later comes a 0, then the word, then
// the word again from bit 1 upwards.
#pragma once

#include <cstdint>

#include "device/component/spi_slave.hpp"

namespace unitylink::device {

class SpiWords final : public SpiSlave {
 public:
  SpiWords(Pins& pins, std::uint32_t component, const SpiLines& lines, Clock now);

 private:
  void begun() override;
  void heard(bool bit) override;
  [[nodiscard]] bool shown() override;
  void sample();

  std::uint32_t bits_;  // of a word
  bool numbered_;
  std::uint32_t asked_ = 1;  // a one, and the bits behind the start bit
  bool started_ = false;
  std::uint32_t edges_ = 0;  // at which a bit was shown, since the word could be
  std::uint32_t word_ = 0;
};

}  // namespace unitylink::device
