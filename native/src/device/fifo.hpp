// SPDX-License-Identifier: BSD-3-Clause
// A FIFO slave, with one queue in each direction.
//
//   +0  read: the oldest word from the FPGA, and removes it; bus error when there is none
//       write: one word to the FPGA; bus error when there is no room
//   +1  read: words from the FPGA that wait        +2  read: words the FPGA still has room for
//
// Event: high while words wait. It is low for a moment after a word was taken, or when no word was taken for
// remind_clocks. So an edge event input requests each word once.
//
// On the FPGA's side, `set(+0)` queues a word for the PC, and `get(+0)` takes a word from the PC.
#pragma once

#include <optional>
#include <utility>

#include "device/bus.hpp"
#include "device/configuration.hpp"
#include "device/ring.hpp"

namespace unitylink::device {

class Fifo final : public Bus {
 public:
  Fifo(const FifoConfiguration& configuration, EventSink sink)
      : group_(configuration.event_group),
        remind_clocks_(configuration.remind_clocks),
        sink_(std::move(sink)),
        to_pc_(configuration.depth),
        from_pc_(configuration.depth) {}

  BusReply read(std::uint32_t address, Clock now) override {
    switch (address) {
      case 0: {
        const BusReply reply = take(to_pc_);
        remind(now);
        return reply;
      }
      case 1: return {BusStatus::ok, static_cast<std::uint32_t>(to_pc_.size())};
      default: return {BusStatus::ok, static_cast<std::uint32_t>(from_pc_.free())};
    }
  }

  BusStatus write(std::uint32_t address, std::uint32_t value, Clock) override {
    return address == 0 && from_pc_.push(value) ? BusStatus::ok : BusStatus::error;
  }

  BusReply get(std::uint32_t address, Clock) override {
    switch (address) {
      case 0: return take(from_pc_);
      case 1: return {BusStatus::ok, static_cast<std::uint32_t>(from_pc_.size())};
      default: return {BusStatus::ok, static_cast<std::uint32_t>(to_pc_.free())};
    }
  }

  BusStatus set(std::uint32_t address, std::uint32_t value, Clock now) override {
    const bool first = to_pc_.empty();
    if (address != 0 || !to_pc_.push(value)) {
      return BusStatus::error;
    }
    if (first) {
      remind(now);
    }
    return BusStatus::ok;
  }

  [[nodiscard]] Clock next_clock() const noexcept override { return remind_at_; }
  void advance(Clock now) override {
    if (remind_at_ <= now) {
      remind(now);
    }
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

  void remind(Clock now) {
    if (!group_) {
      return;
    }
    sink_(*group_, false, now);
    if (!to_pc_.empty()) {
      sink_(*group_, true, now);
    }
    remind_at_ = to_pc_.empty() ? never : now + remind_clocks_;
  }

  std::optional<std::uint32_t> group_;
  Clock remind_clocks_;
  Clock remind_at_ = never;
  EventSink sink_;
  Ring<std::uint32_t> to_pc_;
  Ring<std::uint32_t> from_pc_;
};

}  // namespace unitylink::device
