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
    case Status::range: return "ValueRangeError";
    case Status::bad_url: return "UrlError";
    default: return "LinkError";
  }
}

[[noreturn]] void raise(nb::handle type, const nb::object& error) {
  PyErr_SetObject(type.ptr(), error.ptr());
  throw nb::python_error();
}

[[noreturn]] void raise_range(const std::string& text) { raise_unless_ok({Status::range, text}); throw nb::value_error(text.c_str()); }

}  // namespace

void raise_unless_ok(const Outcome& outcome) {
  if (outcome.ok()) {
    return;
  }
  if (PyErr_Occurred() != nullptr) {  // Ctrl-C during the call: that is what happened, not its outcome
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

std::uint32_t word_of(nb::handle value, const char* name) {
  const nb::object index = nb::steal(PyNumber_Index(value.ptr()));
  if (!index.is_valid()) {
    PyErr_Clear();
    raise_range(std::string(name) + " must be a whole number, not " + nb::cast<std::string>(nb::repr(value)));
  }
  int overflow = 0;
  const long long number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0 || number < 0 || number > 0xFFFFFFFFLL) {
    raise_range(std::string(name) + " " + nb::cast<std::string>(nb::str(index)) + " is not in 0..0xffffffff");
  }
  return static_cast<std::uint32_t>(number);
}

std::vector<std::uint32_t> words_of(nb::handle sequence, const char* name) {
  const nb::object fast = nb::steal(PySequence_Fast(sequence.ptr(), ""));
  if (!fast.is_valid()) {
    PyErr_Clear();
    raise_range(std::string(name) + " must be a sequence of whole numbers, not " + nb::cast<std::string>(nb::repr(sequence)));
  }
  const Py_ssize_t size = PySequence_Fast_GET_SIZE(fast.ptr());
  std::vector<std::uint32_t> words;
  words.reserve(static_cast<std::size_t>(size));
  for (Py_ssize_t item = 0; item < size; ++item) {
    words.push_back(word_of(PySequence_Fast_GET_ITEM(fast.ptr(), item), name));
  }
  return words;
}

}  // namespace unitylink::python
