// SPDX-License-Identifier: BSD-3-Clause
// A device on SPI, as most sensors are: the first byte of a frame is the number of a register, with bit 7 for a read.
// The further bytes are of this register and of those behind it.
#pragma once

#include <cstdint>

#include "device/component/spi_slave.hpp"

namespace unitylink::device {

class SpiRegisters final : public SpiSlave {
 public:
  SpiRegisters(Pins& pins, std::uint32_t component, const SpiLines& lines, Clock now);

 private:
  void begun() override;
  void heard(bool bit) override;
  [[nodiscard]] bool shown() override;

  std::uint32_t bits_ = 0;  // of this frame
  std::uint8_t shifted_ = 0;
  std::uint8_t place_ = 0;
  bool reads_ = false;
};

}  // namespace unitylink::device
