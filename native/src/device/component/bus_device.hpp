// SPDX-License-Identifier: BSD-3-Clause
// A device with registers at the pins of a component, for plants: what it reads and writes are bytes in `registers`.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
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
  // The shortest times that the device has seen, in clocks. A datasheet says what they must be at least.
  std::map<std::string, Clock, std::less<>> shortest;

 protected:
  // The number that so many registers are, low byte first.
  [[nodiscard]] std::uint32_t number(std::size_t first, std::size_t bytes) const noexcept {
    std::uint32_t found = 0;
    for (std::size_t place = first + bytes; place > first; --place) {
      found = found << 8 | registers[place - 1];
    }
    return found;
  }
  // What lasts from a clock until now. `never`: it has not begun.
  void lasted(const char* what, Clock from, Clock now) {
    if (from != never) {
      const auto found = shortest.try_emplace(what, now - from).first;
      found->second = std::min(found->second, now - from);
    }
  }
};

// The lines of a device on SPI: places among the outputs, and of miso among the inputs.
struct SpiLines {
  std::uint32_t select_n = 0;
  std::uint32_t sclk = 1;
  std::uint32_t mosi = 2;
  std::uint32_t miso = 0;
  std::uint32_t mode = 0;
  std::uint32_t word_bits = 0;  // it has no registers, and sends words of so many bits
  bool numbered = false;        // it is told which word
};

// The line of a speed controller with DShot: places among the outputs and the inputs. Lengths are clocks.
struct EscLines {
  std::uint32_t out = 0;
  std::uint32_t in = 0;
  double bit = 1;        // the length of a bit
  double answer = 1;     // from the end of a frame to the reply
  bool replies = false;  // it is bidirectional
};

// The line of a bus of servos: places among the outputs and the inputs. Lengths are clocks.
struct ServoLines {
  std::uint32_t out = 0;
  std::uint32_t enable = 1;
  std::uint32_t in = 0;
  double bit = 1;     // the length of a bit
  double answer = 1;  // from the end of a question to the reply
  bool feetech = false;
  std::uint8_t id = 1;
};

// The lines of a device on I2C: places among the outputs and the inputs. `width` is the bytes of a register.
struct I2cLines {
  std::uint32_t scl_drive = 1;
  std::uint32_t sda_drive = 3;
  std::uint32_t scl_in = 0;
  std::uint32_t sda_in = 1;
  std::uint8_t address = 0;
  std::uint8_t width = 1;
};

// The lines of a distance sensor: places among the outputs and the inputs. `us` is the clocks of a microsecond.
struct DistanceLines {
  std::uint32_t trigger = 0;
  std::uint32_t echo = 0;
  double us = 1;
};

// The lines of a load cell behind an HX711: places among the outputs and the inputs.
struct LoadCellLines {
  std::uint32_t sck = 0;
  std::uint32_t dout = 0;
  double us = 1;
};

// The lines of an absolute encoder: places among the outputs and the inputs. `quiet` is after how many clocks without
// an edge the device is ready for the next frame.
struct SerialEncoderLines {
  enum class Kind : std::uint8_t { ssi, biss, chip };

  std::uint32_t sclk = 0;
  std::uint32_t select_n = 0;  // of a chip on SPI only, as mosi
  std::uint32_t mosi = 0;
  std::uint32_t miso = 0;
  Kind kind = Kind::ssi;
  std::uint32_t bits = 13;
  std::uint32_t lead_bits = 0;
  std::uint32_t tail_bits = 0;
  bool gray = true;
  Clock quiet = 1;
};

// The line of a thermometer on 1-wire: places among the outputs and the inputs. It is one pin, of a component whose
// output before `drive` is the level that it drives.
struct ThermometerLines {
  std::uint32_t drive = 1;
  std::uint32_t in = 0;
  double us = 1;

  [[nodiscard]] std::uint32_t out() const noexcept { return drive - 1; }
};

using DeviceLines = std::variant<SpiLines, EscLines, ServoLines, I2cLines, DistanceLines, LoadCellLines,
                                 ThermometerLines, SerialEncoderLines>;

}  // namespace unitylink::device
