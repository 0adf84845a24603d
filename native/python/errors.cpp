// SPDX-License-Identifier: BSD-3-Clause
#include <Python.h>

#include <nanobind/stl/string.h>

#include <string>

#include "bindings.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

const char* class_of(Status status) {
  switch (status) {
    case Status::timeout: return "LinkTimeout";
    case Status::unknown: return "OutcomeUnknown";
    case Status::closed:
    case Status::cancelled: return "LinkClosed";
    case Status::busy: return "LinkBusy";
    case Status::not_found: return "LinkNotFound";
    case Status::bus_error: return "BusError";
    case Status::protocol_error: return "ProtocolError";
    case Status::mismatch: return "DeviceMismatch";
    case Status::denied: return "DeadManTripped";
    case Status::down: return "LinkDown";
    case Status::refused: return "AccessRefused";
    case Status::lease_held: return "LeaseHeld";
    case Status::range: return "ValueRangeError";
    case Status::bad_url: return "UrlError";
    default: return "LinkError";
  }
}

[[noreturn]] void raise(nb::handle type, const nb::object& error) {
  PyErr_SetObject(type.ptr(), error.ptr());
  throw nb::python_error();
}

}  // namespace

void raise_unless_ok(const Outcome& outcome) {
  if (outcome.ok()) {
    return;
  }
  if (PyErr_Occurred() != nullptr) {  // Ctrl-C during the call: this exception has priority over the outcome
    throw nb::python_error();
  }
  const nb::object type = nb::module_::import_("unitylink.errors").attr(class_of(outcome.status));
  if (outcome.status == Status::range || outcome.status == Status::bad_url) {
    raise(type, type(outcome.text));
  }
  nb::object address = nb::none();
  if (outcome.has_address) {
    address = nb::int_(outcome.address);
  }
  raise(type, type(outcome.text, nb::arg("address") = address, nb::arg("attempts") = outcome.attempts,
                   nb::arg("elapsed_s") = static_cast<double>(outcome.elapsed_ns) * 1e-9));
}

}  // namespace unitylink::python
