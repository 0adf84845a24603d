// SPDX-License-Identifier: BSD-3-Clause
// A FIFO slave, one queue each way.
//
//   +0  read: the oldest word from the FPGA, and removes it; bus error when there is none
//       write: one word to the FPGA; bus error when there is no room
//   +1  read: words from the FPGA that wait        +2  read: words the FPGA still has room for
//
// On the FPGA's side `set(+0)` queues a word for the PC and `get(+0)` takes one of the PC's.
#pragma once

#include "device/bus.hpp"
#include "device/ring.hpp"

namespace unitylink::device {

class Fifo final : public Bus {
 public:
  explicit Fifo(std::uint32_t depth) : to_pc_(depth), from_pc_(depth) {}

  BusReply read(std::uint32_t address, Clock) override {
    switch (address) {
      case 0:
        return take(to_pc_);
      case 1:
        return {BusStatus::ok, static_cast<std::uint32_t>(to_pc_.size())};
      default:
        return {BusStatus::ok, static_cast<std::uint32_t>(from_pc_.free())};
    }
  }

  BusStatus write(std::uint32_t address, std::uint32_t value, Clock) override {
    return address == 0 && from_pc_.push(value) ? BusStatus::ok : BusStatus::error;
  }

  BusReply get(std::uint32_t address, Clock) override {
    switch (address) {
      case 0:
        return take(from_pc_);
      case 1:
        return {BusStatus::ok, static_cast<std::uint32_t>(from_pc_.size())};
      default:
        return {BusStatus::ok, static_cast<std::uint32_t>(to_pc_.free())};
    }
  }

  BusStatus set(std::uint32_t address, std::uint32_t value, Clock) override {
    return address == 0 && to_pc_.push(value) ? BusStatus::ok : BusStatus::error;
  }

 private:
  static BusReply take(Ring<std::uint32_t>& queue) {
    if (queue.empty()) {
      return {BusStatus::error, 0};
    }
    const BusReply reply{BusStatus::ok, queue.front()};
    queue.pop();
    return reply;
  }

  Ring<std::uint32_t> to_pc_;
  Ring<std::uint32_t> from_pc_;
};

}  // namespace unitylink::device
