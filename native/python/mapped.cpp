// SPDX-License-Identifier: BSD-3-Clause
// Mapped memory for Python. The interpreter stays held: an access takes less time than giving it away, and close() cannot come between.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>

#include <memory>
#include <string>
#include <vector>

#include "arrays.hpp"
#include "bindings.hpp"
#include "mapped_memory/mapped_memory.hpp"

namespace nb = nanobind;

namespace unitylink::python {
namespace {

std::unique_ptr<MappedMemory> open(const std::string& path, std::uint64_t offset, std::uint64_t bytes) {
  std::unique_ptr<MappedMemory> memory;
  raise_unless_ok(MappedMemory::open(path, offset, bytes, memory));
  return memory;
}

std::uint32_t read(const MappedMemory& memory, nb::handle address) {
  std::uint32_t value = 0;
  raise_unless_ok(memory.read(word_of(address, "address"), value));
  return value;
}

void write(MappedMemory& memory, nb::handle address, nb::handle value) {
  raise_unless_ok(memory.write(word_of(address, "address"), word_of(value, "value")));
}

nb::object read_many(const MappedMemory& memory, nb::handle addresses) {
  const std::vector<std::uint32_t> words = words_of(addresses, "address");
  auto values = std::make_unique<std::uint32_t[]>(words.size());
  raise_unless_ok(memory.read_many(words, std::span(values.get(), words.size())));
  return array_of(std::move(values), {words.size()});
}

nb::tuple read_settled(const MappedMemory& memory, nb::handle addresses, std::size_t passes) {
  const std::vector<std::uint32_t> words = words_of(addresses, "address");
  auto values = std::make_unique<std::uint32_t[]>(words.size());
  bool settled = false;
  raise_unless_ok(memory.read_settled(words, std::span(values.get(), words.size()), passes, settled));
  return nb::make_tuple(array_of(std::move(values), {words.size()}), settled);
}

}  // namespace

void bind_mapped(nb::module_& module) {
  using namespace nb::literals;
  nb::class_<MappedMemory>(module, "MappedMemory")
      .def("read", &read, "address"_a)
      .def("write", &write, "address"_a, "value"_a)
      .def("read_many", &read_many, "addresses"_a)
      .def("read_settled", &read_settled, "addresses"_a, "passes"_a)
      .def("close", &MappedMemory::close)
      .def_prop_ro("words", &MappedMemory::words)
      .def_prop_ro("closed", &MappedMemory::closed);
  module.def("map_memory", &open, "path"_a, "offset"_a, "bytes"_a);
}

}  // namespace unitylink::python
