// SPDX-License-Identifier: BSD-3-Clause
// The device at the pins of a component, for Python.
#pragma once

#include <nanobind/stl/optional.h>
#include <nanobind/stl/tuple.h>

#include <cstdint>
#include <optional>
#include <tuple>

#include "bindings.hpp"
#include "device/board.hpp"

namespace unitylink::python {

struct BoardDevice {
  device::Board* board;
  std::uint32_t component;
  std::uint32_t out;  // its place: the first of its lines, and 256 more for each id of a servo
};

using SpiPins = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;

// Puts a device on SPI at pins of a component: select_n, sclk, mosi and miso. With `word_bits` it has no registers, and
// sends words. None: it has no such pins.
template <class PythonBoard>
std::optional<BoardDevice> attach_spi(PythonBoard& self, std::uint32_t component, const SpiPins& pins,
                                      std::uint32_t mode, std::uint32_t word_bits, bool numbered) {
  const auto [select_n, sclk, mosi, miso] = pins;
  const GilRelease released;
  if (!self.attach(component, device::SpiLines{select_n, sclk, mosi, miso, mode, word_bits, numbered})) {
    return std::nullopt;
  }
  return BoardDevice{&self, component, select_n};
}

// Puts a speed controller at the pins out and in of a component. Lengths are clocks. None: it has no such pins.
template <class PythonBoard>
std::optional<BoardDevice> attach_esc(PythonBoard& self, std::uint32_t component,
                                      const std::tuple<std::uint32_t, std::uint32_t>& pins, double bit, double answer,
                                      bool replies) {
  const auto [out, in] = pins;
  const GilRelease released;
  if (!self.attach(component, device::EscLines{out, in, bit, answer, replies})) {
    return std::nullopt;
  }
  return BoardDevice{&self, component, out};
}

// Puts a servo of a bus at the pins out, enable and in of a component. Lengths are clocks. None: it has no such pins.
template <class PythonBoard>
std::optional<BoardDevice> attach_servo(PythonBoard& self, std::uint32_t component,
                                        const std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>& pins, double bit,
                                        double answer, bool feetech, std::uint8_t id) {
  const auto [out, enable, in] = pins;
  const GilRelease released;
  if (!self.attach(component, device::ServoLines{out, enable, in, bit, answer, feetech, id})) {
    return std::nullopt;
  }
  return BoardDevice{&self, component, out + 256u * id};
}

using I2cPins = std::tuple<std::uint32_t, std::uint32_t, std::uint32_t, std::uint32_t>;

// Puts a device on I2C at pins of a component: scl_drive, sda_drive, scl_in and sda_in. None: it has no such pins.
template <class PythonBoard>
std::optional<BoardDevice> attach_i2c(PythonBoard& self, std::uint32_t component, const I2cPins& pins,
                                      std::uint8_t address, std::uint8_t width) {
  const auto [scl_drive, sda_drive, scl_in, sda_in] = pins;
  const GilRelease released;
  if (!self.attach(component, device::I2cLines{scl_drive, sda_drive, scl_in, sda_in, address, width})) {
    return std::nullopt;
  }
  return BoardDevice{&self, component, scl_drive};
}

// Puts an absolute encoder at sclk, select_n, mosi and miso of a component. `form`: kind, bits, and those before and
// behind. `quiet` is clocks. None: it has no such pins.
template <class PythonBoard>
std::optional<BoardDevice> attach_serial_encoder(
    PythonBoard& self, std::uint32_t component, const SpiPins& pins,
    const std::tuple<std::uint8_t, std::uint32_t, std::uint32_t, std::uint32_t>& form, bool gray, double quiet) {
  const auto [sclk, select_n, mosi, miso] = pins;
  const auto [kind, bits, lead_bits, tail_bits] = form;
  using Kind = device::SerialEncoderLines::Kind;
  const GilRelease released;
  if (!self.attach(component,
                   device::SerialEncoderLines{sclk, select_n, mosi, miso, static_cast<Kind>(kind), bits, lead_bits,
                                              tail_bits, gray, static_cast<device::Clock>(quiet)})) {
    return std::nullopt;
  }
  return BoardDevice{&self, component, sclk};
}

// Puts a sensor with lines of its own at an output and an input of a component. `us` is the clocks of a microsecond.
// None: it has no such pins.
template <class Lines, class PythonBoard>
std::optional<BoardDevice> attach_sensor(PythonBoard& self, std::uint32_t component,
                                         const std::tuple<std::uint32_t, std::uint32_t>& pins, double us) {
  const auto [out, in] = pins;
  const GilRelease released;
  if (!self.attach(component, Lines{out, in, us})) {
    return std::nullopt;
  }
  return BoardDevice{&self, component, out};
}

template <class PythonBoard>
nanobind::object look_at_pin(PythonBoard& self, std::uint32_t component, std::uint32_t pin) {
  std::optional<device::SeenPin> seen;
  {
    const GilRelease released;
    seen = self.look(component, pin);
  }
  return seen
             ? nanobind::object(nanobind::make_tuple(seen->level, seen->rises, seen->steps, seen->high_s, seen->time_s))
             : nanobind::none();
}

}  // namespace unitylink::python
