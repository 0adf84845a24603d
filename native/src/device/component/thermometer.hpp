// SPDX-License-Identifier: BSD-3-Clause
// A thermometer DS18B20 at the line of `one_wire`.
//
// Its registers 0 to 7 are its scratchpad. 16 and 17 are what the next conversion gives in 1/16 degC, low byte first.
// 18 to 21 are the clocks of a conversion. A 1 in 22 says that its power was away for a moment. 23 counts presence
// pulses.
#pragma once

#include <cstdint>

#include "device/component/bus_device.hpp"
#include "device/component/pins.hpp"

namespace unitylink::device {

class Thermometer final : public BusDevice {
 public:
  // The lines must be pins of `component`.
  Thermometer(Pins& pins, std::uint32_t component, const ThermometerLines& lines, Clock now);

 private:
  enum class State { idle, rom, command, writing, converting, reading };

  void edge(Clock state);
  void falls(Clock state);
  void rises(Clock state);
  void restart() noexcept;
  void hear(bool bit, Clock state);
  void obey(Clock state);
  void pull(double after_us, double until_us, Clock from);
  [[nodiscard]] bool next_bit(Clock state);
  [[nodiscard]] std::uint8_t check() const noexcept;
  void finish() noexcept;

  Pins& pins_;
  std::uint32_t component_;
  ThermometerLines lines_;
  const OutputPin* out_;
  const OutputPin* drive_;
  State state_ = State::idle;
  bool low_ = false;
  Clock fell_ = 0;
  Clock ready_ = 0;  // when the conversion ends
  std::uint32_t bits_ = 0;
  std::uint32_t shift_ = 0;
};

}  // namespace unitylink::device
