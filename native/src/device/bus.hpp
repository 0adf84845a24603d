// SPDX-License-Identifier: BSD-3-Clause
// The bus behind the application layer, as every slave implements it.
#pragma once

#include <cstdint>
#include <functional>

#include "device/clock.hpp"

namespace unitylink::device {

enum class BusStatus : std::uint8_t { ok, error, silent, denied };  // denied: a write, and the dead-man has tripped

struct BusReply {
  BusStatus status = BusStatus::ok;
  std::uint32_t value = 0;
};

// Addresses are relative to the slave. `read`, `write` and `block` are what the link does; `get` and `set` are the FPGA's
// own side of the same words, where plants attach.
class Bus {
 public:
  virtual ~Bus() = default;
  virtual BusReply read(std::uint32_t address, Clock now) = 0;
  virtual BusStatus write(std::uint32_t address, std::uint32_t value, Clock now) = 0;
  // True from the first until after the last word of a read-many or publish: its words must belong together.
  virtual void block(bool /*held*/, Clock /*now*/) {}
  virtual BusReply get(std::uint32_t address, Clock now) = 0;
  virtual BusStatus set(std::uint32_t address, std::uint32_t value, Clock now) = 0;
  // When advance() has something to do by itself.
  [[nodiscard]] virtual Clock next_clock() const noexcept { return never; }
  virtual void advance(Clock /*now*/) {}
};

// The event input of a group changes. Given by whoever has the groups.
using EventSink = std::function<void(std::uint32_t group, bool high, Clock now)>;

}  // namespace unitylink::device
