// SPDX-License-Identifier: BSD-3-Clause
// Converts words from Python: any integers, in any sequence.
#include <Python.h>

#include <nanobind/stl/string.h>

#include <string>

#include "bindings.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

constexpr long long word_max = 0xFFFFFFFFLL;
constexpr std::size_t text_max = 200;  // an error shows at most so many characters of an argument

[[noreturn]] void raise_range(const std::string& text) {
  raise_unless_ok({Status::range, text});
  throw nb::value_error(text.c_str());
}

// Converts an integer that is not Python's `int`, such as one of numpy. Raises an error for all else.
std::uint32_t other_word_of(nb::handle value, const char* name) {
  const nb::object index = nb::steal(PyNumber_Index(value.ptr()));
  if (!index.is_valid()) {
    PyErr_Clear();
    raise_range(std::string(name) + " must be a whole number, not " + told(value));
  }
  int overflow = 0;
  const long long number = PyLong_AsLongLongAndOverflow(index.ptr(), &overflow);
  if (overflow != 0 || number < 0 || number > word_max) {
    raise_range(std::string(name) + " " + told(index) + " is not in 0..0xffffffff");
  }
  return static_cast<std::uint32_t>(number);
}

// The items of an iterable object, as a tuple, which nobody else changes. Null: it is not iterable.
nb::object items_of(nb::handle iterable) {
  nb::object items = nb::steal(PySequence_Tuple(iterable.ptr()));
  if (!items.is_valid()) {
    PyErr_Clear();
  }
  return items;
}

std::size_t size_of(const nb::object& items) noexcept { return static_cast<std::size_t>(PyTuple_Size(items.ptr())); }

nb::handle item_of(const nb::object& items, std::size_t item) noexcept {
  return PyTuple_GetItem(items.ptr(), static_cast<Py_ssize_t>(item));
}

}  // namespace

std::string told(nb::handle object) {
  const nb::object text = nb::steal(PyObject_Repr(object.ptr()));
  if (!text.is_valid()) {  // an integer with more digits than Python converts to text
    PyErr_Clear();
    return "a " + nb::cast<std::string>(nb::str(nb::type_name(object.type()))) + " that cannot be shown";
  }
  const auto whole = nb::cast<std::string>(text);
  return whole.size() <= text_max ? whole : whole.substr(0, text_max) + "...";
}

std::uint32_t word_of(nb::handle value, const char* name) {
  if (PyLong_CheckExact(value.ptr())) {
    int overflow = 0;
    const long long number = PyLong_AsLongLongAndOverflow(value.ptr(), &overflow);
    if (overflow == 0 && number >= 0 && number <= word_max) {
      return static_cast<std::uint32_t>(number);
    }
  }
  return other_word_of(value, name);
}

std::vector<std::uint32_t> words_of(nb::handle sequence, const char* name) {
  const nb::object items = items_of(sequence);
  if (!items.is_valid()) {
    raise_range(std::string(name) + " must be a sequence of whole numbers, not " + told(sequence));
  }
  std::vector<std::uint32_t> words;
  words.reserve(size_of(items));
  for (std::size_t item = 0; item < size_of(items); ++item) {
    words.push_back(word_of(item_of(items, item), name));
  }
  return words;
}

Writes writes_of(nb::handle pairs) {
  const nb::object items = items_of(pairs);
  if (!items.is_valid()) {
    raise_range("writes must be a sequence of pairs (address, value), not " + told(pairs));
  }
  Writes writes;
  writes.addresses.reserve(size_of(items));
  writes.values.reserve(size_of(items));
  for (std::size_t item = 0; item < size_of(items); ++item) {
    const nb::handle given = item_of(items, item);
    const nb::object pair = items_of(given);
    if (!pair.is_valid() || size_of(pair) != 2) {
      raise_range("a write must be a pair (address, value), not " + told(given));
    }
    writes.addresses.push_back(word_of(item_of(pair, 0), "address"));
    writes.values.push_back(word_of(item_of(pair, 1), "value"));
  }
  return writes;
}

}  // namespace unitylink::python
