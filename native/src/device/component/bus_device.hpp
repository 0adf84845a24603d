// SPDX-License-Identifier: BSD-3-Clause
// A device with registers at the pins of a component, for plants: what it reads and writes are bytes in `registers`.
#pragma once

#include <array>
#include <cstdint>

#include "device/clock.hpp"

namespace unitylink::device {

class BusDevice {
 public:
  BusDevice() = default;
  BusDevice(const BusDevice&) = delete;
  BusDevice& operator=(const BusDevice&) = delete;
  virtual ~BusDevice() = default;

  std::array<std::uint8_t, 256> registers{};
  bool plugged = true;  // else it neither hears nor answers
};

// The lines of a device on SPI: places among the outputs, and of miso among the inputs.
struct SpiLines {
  std::uint32_t select_n = 0;
  std::uint32_t sclk = 1;
  std::uint32_t mosi = 2;
  std::uint32_t miso = 0;
  std::uint32_t mode = 0;
};

}  // namespace unitylink::device
