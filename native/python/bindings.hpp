// SPDX-License-Identifier: BSD-3-Clause
// The parts of the module unitylink._native, and how a failed Outcome becomes a Python exception.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

#include "device/bus.hpp"
#include "device/component/component_configuration.hpp"
#include "device/configuration.hpp"
#include "device/rtl_device.hpp"
#include "layer0_driver/status.hpp"

namespace unitylink::python {

void bind_driver(nanobind::module_& module);
void bind_stream(nanobind::module_& module);
void bind_link(nanobind::module_& module);
void bind_board(nanobind::module_& module);
void bind_board_device(nanobind::module_& module);
void bind_bus(nanobind::module_& module);
void bind_component(nanobind::module_& module);
void bind_faults(nanobind::module_& module);
void bind_server(nanobind::module_& module);
void bind_samples(nanobind::module_& module);

// Releases the GIL as long as it exists. If the process ends meanwhile, Python would end this thread by unwinding its
// stack, and C++ would then call abort(). So the thread waits here until the process is gone.
class GilRelease {
 public:
  GilRelease() noexcept : state_(PyEval_SaveThread()) {}
  GilRelease(const GilRelease&) = delete;
  GilRelease& operator=(const GilRelease&) = delete;
  ~GilRelease() {
    try {
      PyEval_RestoreThread(state_);
    } catch (...) {
      while (true) {
        ::pause();
      }
    }
  }

 private:
  PyThreadState* state_;
};

// Raises the exception of unitylink.errors that belongs to the status. It returns only if the status is ok.
void raise_unless_ok(const Outcome& outcome);

// Reads a simulate.BoardConfiguration, whose attributes have the names of the fields. Raises ValueRangeError for a
// wrong value.
[[nodiscard]] device::DeviceConfiguration configuration_of(nanobind::handle object);

// Reads an interface.ComponentConfiguration.
[[nodiscard]] device::ComponentConfiguration component_configuration_of(nanobind::handle from, std::uint32_t data_bits);

// Makes a device from a simulate.rtl.RtlModel, which names the compiled gateware. Raises ToolError if it cannot be
// used.
[[nodiscard]] std::unique_ptr<device::RtlDevice> make_rtl_device(nanobind::handle model,
                                                                 const device::DeviceConfiguration& configuration);

// The value of a register, or None if the bus refuses or nothing answers.
[[nodiscard]] nanobind::object value_of(const device::BusReply& reply);

// Converts any Python integer, also of numpy, to a word. Raises ValueRangeError, which says what `name` may be.
[[nodiscard]] std::uint32_t word_of(nanobind::handle value, const char* name);
[[nodiscard]] std::vector<std::uint32_t> words_of(nanobind::handle sequence, const char* name);
// The text by which Python shows an argument, for an error message.
[[nodiscard]] std::string told(nanobind::handle object);

// Words to write, from a sequence of pairs (address, value).
struct Writes {
  std::vector<std::uint32_t> addresses;
  std::vector<std::uint32_t> values;
};
[[nodiscard]] Writes writes_of(nanobind::handle pairs);

}  // namespace unitylink::python
