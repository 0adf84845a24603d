// SPDX-License-Identifier: BSD-3-Clause
// The twin for Python: the device alone, on a clock that the caller owns, and the board, which serves a device on an
// endpoint.
#include <nanobind/stl/function.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <random>
#include <string>
#include <vector>

#include "bindings.hpp"
#include "board_device.hpp"
#include "board_words.hpp"
#include "device/board.hpp"
#include "device/device.hpp"
#include "device/rtl_device.hpp"
#include "device/word_plant.hpp"
#include "interpreter_state.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

using namespace unitylink::device;

[[noreturn]] void raise_error(const char* name, const std::string& text) {
  const nb::object type = nb::module_::import_("unitylink.errors").attr(name);
  PyErr_SetObject(type.ptr(), nb::object(type(text)).ptr());
  throw nb::python_error();
}

// Reads each setting from the attribute with its name.
struct SettingReader {
  nb::handle from;

  void operator()(const char* name, std::uint32_t& field) const { field = word_of(attribute(name), name); }
  void operator()(const char* name, std::uint64_t& field) const { field = nb::cast<std::uint64_t>(attribute(name)); }
  void operator()(const char* name, bool& field) const { field = nb::cast<bool>(attribute(name)); }
  void operator()(const char* name, std::bitset<256>& field) const {
    for (nb::handle group : attribute(name)) {
      const std::uint32_t number = word_of(group, name);
      if (number >= field.size()) {
        raise_error("ValueRangeError", std::string(name) + " has " + std::to_string(number) + "; choose 0 to 255");
      }
      field.set(number);
    }
  }
  template <class Choice>
  void operator()(const char* name, Choice& field) const {
    const auto text = nb::cast<std::string>(attribute(name));
    if (!choose(text, field)) {
      raise_error("ValueRangeError", std::string(name) + " is '" + text + "', which it cannot be");
    }
  }

 private:
  [[nodiscard]] nb::object attribute(const char* name) const { return from.attr(name); }
};

}  // namespace

std::unique_ptr<RtlDevice> make_rtl_device(nb::handle model, const DeviceConfiguration& configuration) {
  const auto library = nb::cast<std::string>(model.attr("library"));
  RtlWords words{addresses_of(model, "read_addresses"), addresses_of(model, "write_addresses"), {}};
  for (nb::handle places : nb::object(model.attr("pin_places"))) {
    words.pins.push_back(
        {nb::cast<std::vector<std::uint32_t>>(places[0]), nb::cast<std::vector<std::uint32_t>>(places[1])});
  }
  std::string problem;
  try {
    return std::make_unique<RtlDevice>(library, std::move(words), configuration);
  } catch (const RtlError& error) {
    problem = error.what();
  }
  raise_error("ToolError", problem);
}

DeviceConfiguration configuration_of(nb::handle object) {
  const auto word = [](nb::handle from, const char* name) { return word_of(nb::object(from.attr(name)), name); };
  const auto byte = [&word](nb::handle from, const char* name) {
    const std::uint32_t value = word(from, name);
    if (value > 0xFF) {
      raise_error("ValueRangeError", std::string(name) + " is " + std::to_string(value) + "; choose 0 to 255");
    }
    return static_cast<std::uint8_t>(value);
  };
  const auto ranges = [](nb::handle list, const char* name) {
    std::vector<AddressRange> result;
    for (nb::handle range : list) {
      result.push_back({word_of(nb::object(range[0]), name), word_of(nb::object(range[1]), name)});
    }
    return result;
  };
  DeviceConfiguration result;
  each_setting(result, SettingReader{object});
  result.bus_error_ranges = ranges(object.attr("bus_error_ranges"), "bus_error_ranges");
  result.silent_ranges = ranges(object.attr("silent_ranges"), "silent_ranges");
  if (const nb::object tosnet = object.attr("tosnet"); !tosnet.is_none()) {
    result.tosnet.present = true;
    result.tosnet.base = word(tosnet, "base");
    result.tosnet.master_id = byte(tosnet, "master_id");
    result.tosnet.master_registers = byte(tosnet, "master_registers");
    result.tosnet.cycle_clocks = word(tosnet, "cycle_clocks");
    result.tosnet.max_skipped_writes = word(tosnet, "max_skipped_writes");
    result.tosnet.rings = byte(tosnet, "rings");
    for (nb::handle node : nb::object(tosnet.attr("nodes"))) {
      result.tosnet.nodes.push_back({byte(node, "id"), byte(node, "registers")});
    }
    result.tosnet.node_safe = safe_values_of(tosnet, "node_safe");
    if (const nb::object group = tosnet.attr("event_group"); !group.is_none()) {
      result.tosnet.event_group = word_of(group, "event_group");
    }
  }
  for (nb::handle fifo : nb::object(object.attr("fifos"))) {
    FifoConfiguration chosen{word(fifo, "base"), word(fifo, "depth"), std::nullopt, word(fifo, "remind_clocks")};
    if (const nb::object group = fifo.attr("event_group"); !group.is_none()) {
      chosen.event_group = word_of(group, "event_group");
    }
    result.fifos.push_back(chosen);
  }
  for (nb::handle buffer : nb::object(object.attr("double_buffers"))) {
    result.double_buffers.push_back({word(buffer, "base"), word(buffer, "size")});
  }
  for (nb::handle one : nb::object(object.attr("components"))) {
    result.components.push_back(component_configuration_of(one, result.data_bits));
    for (CarriedWord& carried : result.components.back().carried) {
      carried.address -= result.tosnet.base;
    }
  }
  result.safe_words = safe_values_of(object, "safe_words");
  result.flag_words = addresses_of(object, "flag_words");
  result.strobe_words = addresses_of(object, "strobe_words");
  std::sort(result.flag_words.begin(), result.flag_words.end());
  std::sort(result.strobe_words.begin(), result.strobe_words.end());
  if (const std::string problem = result.problem(); !problem.empty()) {
    raise_error("ValueRangeError", "board configuration: " + problem);
  }
  return result;
}

// Reading a word that does not exist gives None, and writing it gives False.
nb::object value_of(const BusReply& reply) {
  return reply.status == BusStatus::ok ? nb::object(nb::int_(reply.value)) : nb::none();
}

namespace {

nb::dict statistics_of(const DeviceStatistics& from) {
  nb::dict result;
  result["bytes_received"] = from.bytes_received;
  result["bytes_sent"] = from.bytes_sent;
  result["overruns"] = from.overruns;
  result["datalink_errors"] = from.datalink_errors;
  return result;
}

// Releases the GIL when it is destroyed, because its thread may be in a plant's step, which needs the GIL to end.
class PythonBoard final : public Board {
 public:
  using Board::Board;
  ~PythonBoard() {
    const GilRelease released;
    stop();
  }
};

PythonBoard* make_board(nb::handle configuration, const std::string& endpoint, const std::string& bind,
                        nb::handle model) {
  DeviceConfiguration chosen = configuration_of(configuration);
  if (endpoint.starts_with("udp")) {  // with UDP, anybody can send datagrams in the name of another client
    std::random_device random;
    chosen.offer_secret = std::uint64_t{random()} << 32 | random() | 1;
  }
  std::unique_ptr<ServedDevice> device = served_device(chosen, model);
  std::string problem;
  try {
    return new PythonBoard(std::move(device), make_endpoint(endpoint, bind));
  } catch (const EndpointError& error) {
    problem = error.what();
  }
  raise_error("LinkNotFound", problem);
}

void bind_device(nb::module_& module) {
  nb::class_<ServedDevice>(module, "ServedDevice",
                           "A device on a clock the caller owns; times are clock cycles since reset.")
      .def_prop_ro("clock", &ServedDevice::clock)
      .def_prop_ro("input_empty", &ServedDevice::input_empty)
      .def_prop_ro("next_event",
                   [](const ServedDevice& self) -> nb::object {
                     const Clock next = self.next_event();
                     return next == never ? nb::none() : nb::object(nb::int_(next));
                   })
      .def(
          "receive",
          [](ServedDevice& self, nb::bytes data) {
            std::size_t taken = 0;
            while (taken < data.size() && self.receive(static_cast<std::uint8_t>(data.c_str()[taken]))) {
              ++taken;
            }
            return taken;
          },
          nb::arg("data"), "Offers bytes from the host, now; returns how many there was room for.")
      .def("receive_error", &ServedDevice::receive_error, nb::arg("bits"))
      .def("run_until", &ServedDevice::run_until, nb::arg("clock"))
      .def(
          "take",
          [](ServedDevice& self) {
            std::string bytes;
            TimedByte byte;
            while (self.take(byte)) {
              bytes.push_back(static_cast<char>(byte.byte));
            }
            return nb::bytes(bytes.data(), bytes.size());
          },
          "Everything that has left the device.")
      .def(
          "take_timed",
          [](ServedDevice& self) {
            std::vector<std::pair<Clock, std::uint8_t>> bytes;
            TimedByte byte;
            while (self.take(byte)) {
              bytes.emplace_back(byte.at, byte.byte);
            }
            return bytes;
          },
          "Everything that has left the device, as (clock, byte).")
      .def(
          "get", [](ServedDevice& self, std::uint32_t address) { return value_of(self.get(address)); },
          nb::arg("address"))
      .def(
          "set",
          [](ServedDevice& self, std::uint32_t address, std::uint32_t value) {
            return self.set(address, value) == BusStatus::ok;
          },
          nb::arg("address"), nb::arg("value"))
      .def("statistics", [](const ServedDevice& self) { return statistics_of(self.statistics()); })
      .def_prop_ro("failure", &ServedDevice::failure,
                   "The assertion of compiled gateware that failed; empty while none has.");
  nb::class_<Device, ServedDevice>(module, "Device", "The twin.")
      .def(
          "__init__",
          [](Device* self, nb::handle configuration) { new (self) Device(configuration_of(configuration)); },
          nb::arg("configuration"))
      .def_prop_ro("last_activity", &Device::last_activity)
      .def("set_events", &Device::set_events, nb::arg("mask"));
  nb::class_<RtlDevice, ServedDevice>(module, "RtlDevice", "The gateware itself, compiled; every clock is run.")
      .def(nb::new_([](nb::handle configuration, nb::handle model) {
             return make_rtl_device(model, configuration_of(configuration)).release();
           }),
           nb::arg("configuration"), nb::arg("model"))
      .def("reset", &RtlDevice::reset)
      .def(
          "set_events",
          [](RtlDevice& self, std::uint32_t mask) {
            for (std::uint32_t group = 0; group < 32; ++group) {
              self.set_event(group, (mask >> group & 1u) != 0);
            }
          },
          nb::arg("mask"), "Sets the event inputs of the first 32 groups.");
}

}  // namespace

void bind_board(nb::module_& module) {
  bind_device(module);
  using Release = nb::call_guard<GilRelease>;
  nb::class_<PythonBoard>(module, "Board",
                          "A thread that serves a device on an endpoint; use unitylink.simulate.Board.")
      .def(nb::new_([](nb::handle configuration, const std::string& endpoint, const std::string& bind,
                       nb::handle model) { return make_board(configuration, endpoint, bind, model); }),
           nb::arg("configuration"), nb::arg("endpoint"), nb::arg("bind"), nb::arg("model").none() = nb::none())
      .def(
          "set_plant",
          [](PythonBoard& self, double period_s, nb::callable step) {
            self.set_plant({period_s, [step, &self](double time_s) {
                              if (!self.in_steps()) {  // else it is a thread of Python, which has its state
                                keep_interpreter_state();
                              }
                              const nb::gil_scoped_acquire acquired;
                              try {
                                return nb::cast<bool>(step(time_s));
                                // simulate.Board catches all; this is only a last resort
                              } catch (nb::python_error& error) {
                                if (self.in_steps() && error.matches(PyExc_KeyboardInterrupt)) {
                                  PyErr_SetInterrupt();  // it is for the program whose call runs the plant
                                  return true;
                                }
                                error.discard_as_unraisable("a plant's step");
                                return false;
                              }
                            }});
          },
          nb::arg("period_s"), nb::arg("step"), "Before start(): step(time_s) -> bool is called by the board's thread.")
      .def(
          "set_word_plant",
          [](PythonBoard& self, double period_s,
             const std::vector<std::tuple<std::uint32_t, std::int32_t, std::uint32_t, double>>& ramps,
             const std::vector<std::pair<std::uint32_t, std::uint32_t>>& echoes) {
            std::vector<Ramp> counting;
            for (const auto& [address, low, span, pace_hz] : ramps) {
              counting.push_back({address, low, span, pace_hz});
            }
            std::vector<Echo> echoing;
            for (const auto& [from, to] : echoes) {
              echoing.push_back({from, to});
            }
            self.set_plant(period_s, WordPlant(std::move(counting), std::move(echoing)));
          },
          nb::arg("period_s"), nb::arg("ramps"), nb::arg("echoes"))
      .def("start",
           [](PythonBoard& self) {
             std::string problem;
             try {
               const GilRelease released;
               self.start();
               return;
             } catch (const TimeConflict& conflict) {
               problem = conflict.what();
             }
             raise_error("UnityLinkError", problem);
           })
      .def("begin_anew", &begin_anew<PythonBoard>, nb::arg("configuration"), nb::arg("model").none())
      .def_prop_ro("in_steps", &PythonBoard::in_steps)
      .def("stop", &Board::stop, Release())
      .def("url",
           [](PythonBoard& self) {
             std::string url;
             std::string problem;
             {
               const GilRelease released;
               try {
                 url = self.url();
               } catch (const EndpointError& error) {
                 problem = error.what();
               }
             }
             if (!problem.empty()) {
               raise_error("LinkClosed", problem);
             }
             return url;
           })
      .def("time_s", &Board::time_s, Release())
      .def("failure", &Board::failure, Release(), "The assertion of the gateware that failed; empty while none has.")
      .def(
          "get",
          [](PythonBoard& self, std::uint32_t address) {
            BusReply reply;
            {
              const GilRelease released;
              reply = self.get(address);
            }
            return value_of(reply);
          },
          nb::arg("address"))
      .def(
          "set",
          [](PythonBoard& self, std::uint32_t address, std::uint32_t value) {
            return self.set(address, value) == BusStatus::ok;
          },
          nb::arg("address"), nb::arg("value"), Release())
      .def("preset", &preset<PythonBoard>, nb::arg("address"), nb::arg("value"), Release())
      .def("write", &write<PythonBoard>, nb::arg("address"), nb::arg("value"), Release())
      .def("hold_plant", &Board::hold_plant, Release())
      .def_prop_ro("plant_phase", [](PythonBoard& self) { return plant_phase(self); })
      .def("release_plant", &release_plant<PythonBoard>, nb::arg("clock"), nb::arg("wait"), Release())
      .def("get_many", &get_many<PythonBoard>, nb::arg("addresses"), Release())
      .def("set_many", &set_many<PythonBoard>, nb::arg("addresses"), nb::arg("words"), Release())
      .def("set_event", &Board::set_event, nb::arg("group"), nb::arg("high"), Release())
      .def("pulse_event", &Board::pulse_event, nb::arg("group"), Release())
      .def("receive_error", &Board::receive_error, nb::arg("bits"), Release())
      .def("damage_cycle", &Board::damage_cycle, Release())
      .def("hang_up", &Board::hang_up, Release())
      .def("drive", &Board::drive, nb::arg("component"), nb::arg("pin"), nb::arg("level"), Release())
      .def("attach_spi", &attach_spi<PythonBoard>, nb::keep_alive<0, 1>())
      .def("attach_esc", &attach_esc<PythonBoard>, nb::keep_alive<0, 1>())
      .def("attach_i2c", &attach_i2c<PythonBoard>, nb::keep_alive<0, 1>())
      .def("attach_servo", &attach_servo<PythonBoard>, nb::keep_alive<0, 1>())
      .def("attach_distance", &attach_sensor<DistanceLines, PythonBoard>, nb::keep_alive<0, 1>())
      .def("attach_load_cell", &attach_sensor<LoadCellLines, PythonBoard>, nb::keep_alive<0, 1>())
      .def("attach_serial_encoder", &attach_serial_encoder<PythonBoard>, nb::keep_alive<0, 1>())
      .def("attach_thermometer", &attach_sensor<ThermometerLines, PythonBoard>, nb::keep_alive<0, 1>())
      .def("play", &Board::play, nb::arg("component"), nb::arg("pin"), nb::arg("levels"), Release())
      .def("edges", &Board::edges, nb::arg("component"), nb::arg("pin"), Release())
      .def("count_by", &Board::count_by, nb::arg("component"), nb::arg("pin"), nb::arg("direction"), Release())
      .def(
          "turn",
          [](PythonBoard& self, std::uint32_t component,
             const std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>& at, std::int64_t per_turn,
             std::int64_t counts, double seconds) {
            return self.turn(component, {std::get<0>(at), std::get<1>(at), std::get<2>(at), per_turn}, counts, seconds);
          },
          nb::arg("component"), nb::arg("lines"), nb::arg("per_turn"), nb::arg("counts"), nb::arg("seconds"), Release())
      .def(
          "modulate",
          [](PythonBoard& self, std::uint32_t component, const std::tuple<std::uint32_t, std::uint32_t>& lines,
             double level, double seconds) {
            return self.modulate(component, {std::get<0>(lines), std::get<1>(lines)}, level, seconds);
          },
          nb::arg("component"), nb::arg("lines"), nb::arg("level"), nb::arg("seconds"), Release())
      .def("look", &look_at_pin<PythonBoard>, nb::arg("component"), nb::arg("pin"),
           "(level, rises, steps, high_s, time_s) of an output pin, or None.")
      .def("set_online", &Board::set_online, nb::arg("online"), Release())
      .def("set_ring", &Board::set_ring, nb::arg("ring"), nb::arg("whole"), Release())
      .def("set_node", &Board::set_node, nb::arg("id"), nb::arg("present"), Release())
      .def(
          "async_take",
          [](PythonBoard& self) -> nb::object {
            AsyncWord word;
            bool taken = false;
            {
              const GilRelease released;
              taken = self.async_take(word);
            }
            return taken ? nb::object(nb::make_tuple(word.node, word.data, word.last + 1)) : nb::none();
          },
          "(node, word, bytes in it) of the oldest word the PC sent through the asynchronous channel, or None.")
      .def(
          "async_give",
          [](PythonBoard& self, std::uint8_t node, std::uint32_t data, std::uint8_t bytes) {
            return self.async_give({data, static_cast<std::uint8_t>(bytes - 1), node});
          },
          nb::arg("node"), nb::arg("data"), nb::arg("bytes"), Release())
      .def("statistics", [](PythonBoard& self) {
        BoardStatistics all;
        {
          const GilRelease released;
          all = self.statistics();
        }
        nb::dict result = statistics_of(all.device);
        result["clients"] = all.clients;
        result["bytes_dropped"] = all.bytes_dropped;
        result["plant_steps"] = all.plant_steps;
        result["time_slipped_s"] = all.time_slipped_s;
        return result;
      });
}

}  // namespace unitylink::python
