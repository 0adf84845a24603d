// SPDX-License-Identifier: BSD-3-Clause
// The twin's slaves alone, on a clock that the caller owns. Tests compare the gateware's slaves with them.
#include "bindings.hpp"
#include "device/address_map.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

using namespace unitylink::device;

// `clock` must not be lower than in an earlier call.
class SlaveModel {
 public:
  explicit SlaveModel(const DeviceConfiguration& configuration)
      : configuration_(configuration), map_(configuration_, [](std::uint32_t, bool, Clock) {}) {}
  SlaveModel(const SlaveModel&) = delete;
  SlaveModel& operator=(const SlaveModel&) = delete;

  [[nodiscard]] AddressMap& map() noexcept { return map_; }
  [[nodiscard]] Tosnet& tosnet() {
    if (map_.tosnet() == nullptr) {
      throw nb::value_error("the board has no TosNet");
    }
    return *map_.tosnet();
  }

 private:
  DeviceConfiguration configuration_;
  AddressMap map_;
};

}  // namespace

void bind_bus(nb::module_& module) {
  nb::class_<SlaveModel>(module, "Bus",
                         "The twin's slaves on a clock the caller owns, seen from the bus and from the FPGA.")
      .def(
          "__init__",
          [](SlaveModel* self, nb::handle configuration) { new (self) SlaveModel(configuration_of(configuration)); },
          nb::arg("configuration"))
      .def(
          "read",
          [](SlaveModel& self, std::uint32_t address, Clock clock) {
            return value_of(self.map().read(address, clock));
          },
          nb::arg("address"), nb::arg("clock"), "The word, or None for an error or no answer.")
      .def(
          "write",
          [](SlaveModel& self, std::uint32_t address, std::uint32_t value, Clock clock) {
            return self.map().write(address, value, clock) == BusStatus::ok;
          },
          nb::arg("address"), nb::arg("value"), nb::arg("clock"))
      .def(
          "block", [](SlaveModel& self, bool held, Clock clock) { self.map().block(held, clock); }, nb::arg("held"),
          nb::arg("clock"))
      .def(
          "get",
          [](SlaveModel& self, std::uint32_t address, Clock clock) { return value_of(self.map().get(address, clock)); },
          nb::arg("address"), nb::arg("clock"))
      .def(
          "set",
          [](SlaveModel& self, std::uint32_t address, std::uint32_t value, Clock clock) {
            return self.map().set(address, value, clock) == BusStatus::ok;
          },
          nb::arg("address"), nb::arg("value"), nb::arg("clock"))
      .def(
          "set_online", [](SlaveModel& self, bool online, Clock clock) { self.tosnet().set_online(online, clock); },
          nb::arg("online"), nb::arg("clock"))
      .def(
          "damage_cycle", [](SlaveModel& self, Clock clock) { self.tosnet().damage_cycle(clock); }, nb::arg("clock"))
      .def(
          "async_take",
          [](SlaveModel& self, Clock clock) -> nb::object {
            AsyncWord word;
            return self.tosnet().async_take(word, clock)
                       ? nb::object(nb::make_tuple(word.node, word.data, word.last + 1))
                       : nb::none();
          },
          nb::arg("clock"))
      .def(
          "async_give",
          [](SlaveModel& self, std::uint8_t node, std::uint32_t data, std::uint8_t bytes, Clock clock) {
            return self.tosnet().async_give({data, static_cast<std::uint8_t>(bytes - 1), node}, clock);
          },
          nb::arg("node"), nb::arg("data"), nb::arg("bytes"), nb::arg("clock"));
}

}  // namespace unitylink::python
