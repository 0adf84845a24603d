// SPDX-License-Identifier: BSD-3-Clause
// A device at the lines of SPI: it hears a bit at one edge of sclk, and shows the next one at the other. What the bits
// mean is said by a class below it.
#pragma once

#include <cstdint>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class SpiSlave : public BusDevice {
 protected:
  // The lines must be pins of `component`.
  SpiSlave(Pins& pins, std::uint32_t component, const SpiLines& lines, Clock now);

  // A frame begins, or it has ended.
  virtual void begun() = 0;
  // A bit of mosi.
  virtual void heard(bool bit) = 0;
  // The next level of miso. A device that does not drive the line says 1.
  [[nodiscard]] virtual bool shown() = 0;

 private:
  void select(bool level, Clock state);
  void clock(bool level, Clock state);
  void show(Clock state);

  Pins& pins_;
  std::uint32_t component_;
  SpiLines lines_;
  const OutputPin* mosi_;
  bool selected_ = false;
  Clock selected_from_ = never;  // when select_n has changed
  Clock clocked_from_ = never;   // when sclk has changed in this frame
};

}  // namespace unitylink::device
