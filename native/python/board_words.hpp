// SPDX-License-Identifier: BSD-3-Clause
// Many registers of a board at once, for plants in Python; and what a new board gets of another.
#pragma once

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "bindings.hpp"
#include "device/board.hpp"
#include "device/device.hpp"
#include "device/rtl_device.hpp"

namespace unitylink::python {

using BoardWords = std::vector<std::uint32_t>;

// The addresses in an attribute, in their order.
inline BoardWords addresses_of(nanobind::handle object, const char* name) {
  BoardWords result;
  for (nanobind::handle address : nanobind::object(object.attr(name))) {
    result.push_back(word_of(address, name));
  }
  return result;
}

// The values of a dead-man, or of a broken ring, in an attribute.
inline std::vector<device::SafeValue> safe_values_of(nanobind::handle object, const char* name) {
  std::vector<device::SafeValue> result;
  for (nanobind::handle safe : nanobind::object(object.attr(name))) {
    result.push_back({word_of(nanobind::object(safe[0]), name), word_of(nanobind::object(safe[1]), name)});
  }
  return result;
}

// The words up to the first one that cannot be read.
template <class PythonBoard>
BoardWords get_many(PythonBoard& board, const BoardWords& addresses) {
  BoardWords words(addresses.size());
  words.resize(board.get(addresses, words));
  return words;
}

// Returns how many words were set before one could not be.
template <class PythonBoard>
std::size_t set_many(PythonBoard& board, const BoardWords& addresses, const BoardWords& words) {
  return board.set(addresses, words);
}

template <class PythonBoard>
bool preset(PythonBoard& board, std::uint32_t address, std::uint32_t value) {
  return board.preset(address, value) == device::BusStatus::ok;
}

template <class PythonBoard>
bool write(PythonBoard& board, std::uint32_t address, std::uint32_t value) {
  return board.write(address, value) == device::BusStatus::ok;
}

// The clock of the plant's next step, and the clocks until then. None: it makes none.
template <class PythonBoard>
std::optional<std::pair<device::Clock, device::Clock>> plant_phase(PythonBoard& board) {
  const GilRelease released;
  const auto phase = board.plant_phase();
  return phase.clock == device::never ? std::nullopt : std::optional(std::pair(phase.clock, phase.wait));
}

template <class PythonBoard>
void release_plant(PythonBoard& board, device::Clock clock, device::Clock wait) {
  board.release_plant({clock, wait});
}

// The twin, or compiled gateware.
inline std::unique_ptr<device::ServedDevice> served_device(const device::DeviceConfiguration& configuration,
                                                           nanobind::handle model) {
  if (model.is_none()) {
    return std::make_unique<device::Device>(configuration);
  }
  return make_rtl_device(model, configuration);
}

template <class PythonBoard>
bool begin_anew(PythonBoard& board, nanobind::handle configuration, nanobind::handle model) {
  auto device = served_device(configuration_of(configuration), model);
  const GilRelease released;
  return board.begin_anew(std::move(device));
}

}  // namespace unitylink::python
