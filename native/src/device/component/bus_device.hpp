// SPDX-License-Identifier: BSD-3-Clause
// A device with registers at the pins of a component, for plants: what it reads and writes are bytes in `registers`.
#pragma once

#include <array>
#include <cstdint>
#include <variant>

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

// The line of a speed controller with DShot: places among the outputs and the inputs. Lengths are clocks.
struct EscLines {
  std::uint32_t out = 0;
  std::uint32_t in = 0;
  double bit = 1;        // the length of a bit
  double answer = 1;     // from the end of a frame to the reply
  bool replies = false;  // it is bidirectional
};

using DeviceLines = std::variant<SpiLines, EscLines>;

}  // namespace unitylink::device
