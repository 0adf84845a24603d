// SPDX-License-Identifier: BSD-3-Clause
// The model of fifo.vhd: a memory, and a register at its end.
#pragma once

#include <cstdint>
#include <deque>

#include "device/clock.hpp"

namespace unitylink::device {

class UartBridgeQueue {
 public:
  explicit UartBridgeQueue(std::size_t depth) : depth_(depth) {}

  // Has the memory room in this state?
  [[nodiscard]] bool has_room() const noexcept { return memory_.size() < depth_; }
  // Is there a word at the end in this state, and which one?
  [[nodiscard]] bool is_loaded() const noexcept { return loaded_; }
  [[nodiscard]] std::uint32_t oldest() const noexcept { return oldest_; }
  // The next edge at which a word comes to the end.
  [[nodiscard]] Clock next() const noexcept { return !loaded_ && !memory_.empty() ? memory_.front().seen : never; }

  // Edge `edge` happens: at it a word is taken from the end, and one is put into the memory. Both only if they may.
  void step(Clock edge, bool takes, bool puts, std::uint32_t word) {
    if ((!loaded_ || takes) && !memory_.empty() && memory_.front().seen <= edge) {
      oldest_ = memory_.front().word;
      memory_.pop_front();
      loaded_ = true;
    } else if (takes) {
      loaded_ = false;
    }
    if (puts) {
      memory_.push_back({word, edge + 1});
    }
  }

 private:
  struct Entry {
    std::uint32_t word;
    Clock seen;  // the first edge that may take it out of the memory
  };

  std::size_t depth_;
  std::deque<Entry> memory_;
  bool loaded_ = false;
  std::uint32_t oldest_ = 0;
};

}  // namespace unitylink::device
