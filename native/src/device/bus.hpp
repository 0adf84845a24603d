// SPDX-License-Identifier: BSD-3-Clause
// The interface of all slaves on the bus behind the application layer.
#pragma once

#include <cstdint>
#include <functional>

#include "device/clock.hpp"

namespace unitylink::device {

enum class BusStatus : std::uint8_t { ok, error, silent, denied };  // denied: a write after a trip of the dead-man

struct BusReply {
  BusStatus status = BusStatus::ok;
  std::uint32_t value = 0;
};

// Addresses are relative to the slave. The link uses `read`, `write` and `block`. The FPGA's own side of the same words
// is `get` and `set`, and plants use them.
class Bus {
 public:
  virtual ~Bus() = default;
  virtual BusReply read(std::uint32_t address, Clock now) = 0;
  virtual BusStatus write(std::uint32_t address, std::uint32_t value, Clock now) = 0;
  // `held` is true from the first to the last word of a read-many or publish, because these words must be of one
  // moment.
  virtual void block(bool /*held*/, Clock /*now*/) {}
  virtual BusReply get(std::uint32_t address, Clock now) = 0;
  virtual BusStatus set(std::uint32_t address, std::uint32_t value, Clock now) = 0;
  // Sets a word as it was in another board: also one that only the PC writes, or that a commit hides.
  virtual BusStatus preset(std::uint32_t address, std::uint32_t value, Clock now) { return set(address, value, now); }
  // A word that keeps what `set` gave it, and lets nothing happen: the clocks until this is all that can be seen of the
  // word, whatever was set before. never: it is no such word.
  [[nodiscard]] virtual Clock settles(std::uint32_t /*address*/) const noexcept { return never; }
  // When advance() has something to do without an access.
  [[nodiscard]] virtual Clock next_clock() const noexcept { return never; }
  virtual void advance(Clock /*now*/) {}
};

// Reports a change of a group's event input. The owner of the groups gives this function to the slaves.
using EventSink = std::function<void(std::uint32_t group, bool high, Clock now)>;

}  // namespace unitylink::device
