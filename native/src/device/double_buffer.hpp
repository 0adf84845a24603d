// SPDX-License-Identifier: BSD-3-Clause
// A double-buffered memory slave: a commit makes all that the PC wrote visible to the FPGA at once.
//
//   +0 .. +size-1  write: the hidden bank         read: the visible bank (the FPGA's own words after a block read began
//                                                 are seen from the next block on)
//   +size          write: commit, the banks swap  read: number of commits so far
//
// Hazard, as in the 2012 library: the swap does not copy. A word that is not rewritten before a commit has its value of
// two commits ago. `get` and `set`, on the FPGA's side, use the visible bank.
#pragma once

#include <vector>

#include "device/bus.hpp"

namespace unitylink::device {

class DoubleBuffer final : public Bus {
 public:
  explicit DoubleBuffer(std::uint32_t size)
      : size_(size), banks_{std::vector<std::uint32_t>(size), std::vector<std::uint32_t>(size)}, frozen_(size) {}

  BusReply read(std::uint32_t address, Clock) override {
    if (address == size_) {
      return {BusStatus::ok, commits_};
    }
    return {BusStatus::ok, held_ ? frozen_[address] : banks_[visible_][address]};
  }

  BusStatus write(std::uint32_t address, std::uint32_t value, Clock) override {
    if (address == size_) {
      visible_ ^= 1u;
      ++commits_;
    } else {
      banks_[visible_ ^ 1u][address] = value;
    }
    return BusStatus::ok;
  }

  void block(bool held, Clock) override {
    if (held) {
      frozen_ = banks_[visible_];
    }
    held_ = held;
  }

  BusReply get(std::uint32_t address, Clock) override {
    return {BusStatus::ok, address == size_ ? commits_ : banks_[visible_][address]};
  }

  BusStatus set(std::uint32_t address, std::uint32_t value, Clock) override {
    if (address == size_) {
      return BusStatus::error;
    }
    banks_[visible_][address] = value;
    return BusStatus::ok;
  }

 private:
  std::uint32_t size_;
  std::vector<std::uint32_t> banks_[2];
  std::vector<std::uint32_t> frozen_;
  std::uint32_t visible_ = 0;
  std::uint32_t commits_ = 0;
  bool held_ = false;
};

}  // namespace unitylink::device
