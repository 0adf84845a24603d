// SPDX-License-Identifier: BSD-3-Clause
// What each part of unitylink._native adds to the module, and how a failed Outcome becomes a Python exception.
#pragma once

#include <nanobind/nanobind.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unistd.h>
#include <vector>

#include "device/bus.hpp"
#include "device/configuration.hpp"
#include "device/rtl_device.hpp"
#include "layer0_driver/status.hpp"

namespace unitylink::python {

void bind_driver(nanobind::module_& module);
void bind_stream(nanobind::module_& module);
void bind_link(nanobind::module_& module);
void bind_board(nanobind::module_& module);
void bind_bus(nanobind::module_& module);
void bind_faults(nanobind::module_& module);

// Gives the interpreter to others for a while. Where the process ends meanwhile, Python ends the threads that come back
// for it by unwinding their stacks, which C++ would answer with abort(): such a thread waits here instead until the
// process is gone.
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

// Raises the class of unitylink.errors that belongs to the status; returns only when it is ok.
void raise_unless_ok(const Outcome& outcome);

// Of a simulate.BoardConfiguration, whose attributes have the names of the fields; ValueRangeError says what is wrong.
[[nodiscard]] device::DeviceConfiguration configuration_of(nanobind::handle object);

// Compiled gateware, of the attributes of simulate.rtl.RtlModel; ToolError says what is wrong with it.
[[nodiscard]] std::unique_ptr<device::RtlDevice> make_rtl_device(nanobind::handle model,
                                                                 const device::DeviceConfiguration& configuration);

// A register's value, or None where the bus refuses or nothing is.
[[nodiscard]] nanobind::object value_of(const device::BusReply& reply);

// Any Python integer, numpy's included, as a word; ValueRangeError says what `name` may be otherwise.
[[nodiscard]] std::uint32_t word_of(nanobind::handle value, const char* name);
[[nodiscard]] std::vector<std::uint32_t> words_of(nanobind::handle sequence, const char* name);
// How Python shows an argument, for an error.
[[nodiscard]] std::string told(nanobind::handle object);

// Words to write, of a sequence of pairs (address, value).
struct Writes {
  std::vector<std::uint32_t> addresses;
  std::vector<std::uint32_t> values;
};
[[nodiscard]] Writes writes_of(nanobind::handle pairs);

}  // namespace unitylink::python
