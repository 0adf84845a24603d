// SPDX-License-Identifier: BSD-3-Clause
// Publishes as messages for a network: many of them in one call, because each takes about as long as a put of Zenoh.
#include <nanobind/nanobind.h>
#include <nanobind/ndarray.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "bindings.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

using Times = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

void put_little(std::uint8_t* to, std::uint64_t value, std::size_t bytes) {
  for (std::size_t place = 0; place < bytes; ++place) {
    to[place] = static_cast<std::uint8_t>(value >> 8 * place);
  }
}

// One `bytes` for each time: a number of 32 bits, the time as an integer of 64 bits in ns, and its part of `body`.
nb::list sample_messages(std::uint32_t first, const Times& times_s, std::int64_t since_ns, const nb::bytes& body) {
  const std::size_t count = times_s.shape(0);
  const std::size_t row = count == 0 ? 0 : body.size() / count;
  if (row * count != body.size()) {
    throw nb::value_error(
        (std::to_string(body.size()) + " bytes are no " + std::to_string(count) + " rows of one size").c_str());
  }
  constexpr std::size_t head = 12;
  nb::list messages;
  const auto* rows = static_cast<const std::uint8_t*>(body.data());
  for (std::size_t index = 0; index < count; ++index) {
    const double ns = times_s.data()[index] * 1e9;
    if (!(std::abs(ns) < 9e18)) {
      throw nb::value_error("a publish has no time");
    }
    nb::object message = nb::steal(PyBytes_FromStringAndSize(nullptr, static_cast<Py_ssize_t>(head + row)));
    if (!message.is_valid()) {
      throw nb::python_error();
    }
    auto* bytes = reinterpret_cast<std::uint8_t*>(PyBytes_AsString(message.ptr()));  // it is nobody else's yet
    put_little(bytes, first + static_cast<std::uint32_t>(index), 4);
    put_little(bytes + 4, static_cast<std::uint64_t>(static_cast<std::int64_t>(ns) + since_ns), 8);
    if (row != 0) {
      std::memcpy(bytes + head, rows + index * row, row);
    }
    messages.append(std::move(message));
  }
  return messages;
}

}  // namespace

void bind_samples(nb::module_& module) {
  using namespace nb::literals;
  module.def("sample_messages", &sample_messages, "first"_a, "times_s"_a, "since_ns"_a, "body"_a);
}

}  // namespace unitylink::python
