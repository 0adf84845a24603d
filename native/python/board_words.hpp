// SPDX-License-Identifier: BSD-3-Clause
// Many registers of a board at once, for plants in Python.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "device/board.hpp"

namespace unitylink::python {

using BoardWords = std::vector<std::uint32_t>;

// The words up to the first one that cannot be read.
template <class PythonBoard>
BoardWords get_many(PythonBoard& board, const BoardWords& addresses) {
  BoardWords words;
  words.reserve(addresses.size());
  for (const std::uint32_t address : addresses) {
    const device::BusReply reply = board.get(address);
    if (reply.status != device::BusStatus::ok) {
      break;
    }
    words.push_back(reply.value);
  }
  return words;
}

// Returns how many words were set before one could not be.
template <class PythonBoard>
std::size_t set_many(PythonBoard& board, const BoardWords& addresses, const BoardWords& words) {
  std::size_t done = 0;
  while (done < std::min(addresses.size(), words.size()) &&
         board.set(addresses[done], words[done]) == device::BusStatus::ok) {
    ++done;
  }
  return done;
}

}  // namespace unitylink::python
