// SPDX-License-Identifier: BSD-3-Clause
#include "board_device.hpp"

#include <nanobind/stl/map.h>
#include <nanobind/stl/string.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>

namespace nb = nanobind;

namespace unitylink::python {

using device::BusDevice;

void bind_board_device(nb::module_& module) {
  using Release = nb::call_guard<GilRelease>;
  nb::class_<BoardDevice>(module, "BoardDevice", "The registers of the device at the pins of a component.")
      .def("get",
           [](const BoardDevice& self) {
             std::array<std::uint8_t, 256> found{};
             {
               const GilRelease released;
               self.board->with_device(self.component, self.out,
                                       [&](const BusDevice& device) { found = device.registers; });
             }
             return nb::bytes(reinterpret_cast<const char*>(found.data()), found.size());
           })
      .def(
          "set",
          [](const BoardDevice& self, std::uint32_t first, const nb::bytes& values) {
            const std::string bytes(values.c_str(), values.size());
            const GilRelease released;
            self.board->with_device(self.component, self.out, [&](BusDevice& device) {
              for (std::size_t number = 0; number < bytes.size() && first + number < device.registers.size();
                   ++number) {
                device.registers[first + number] = static_cast<std::uint8_t>(bytes[number]);
              }
            });
          },
          nb::arg("first"), nb::arg("values"), "All at once, and so of one moment.")
      .def(
          "plug",
          [](const BoardDevice& self, bool plugged) {
            self.board->with_device(self.component, self.out,
                                    [plugged](BusDevice& device) { device.plugged = plugged; });
          },
          nb::arg("plugged"), Release())
      .def(
          "shortest",
          [](const BoardDevice& self) {
            std::map<std::string, std::uint64_t> found;
            {
              const GilRelease released;
              self.board->with_device(self.component, self.out, [&found](const BusDevice& device) {
                found.insert(device.shortest.begin(), device.shortest.end());
              });
            }
            return found;
          },
          "The shortest times that it has seen, in clocks.");
}

}  // namespace unitylink::python
