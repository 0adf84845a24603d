// SPDX-License-Identifier: BSD-3-Clause
// Plain words, one for each address. Both sides see the same words at once.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <unordered_map>

#include "device/bus.hpp"

namespace unitylink::device {

// A page is allocated at its first write, so a 32-bit address space uses only the memory that is needed. Beyond
// `pages_most` (64 MiB) a write to a new page is a bus error, so that a host cannot use up the memory of the machine.
class Memory final : public Bus {
 public:
  static constexpr std::size_t page_words = 1024;
  static constexpr std::size_t pages_most = 16384;

  // `bench`: word a starts as 0x40DE0000 | (a * 257 & 0xFFFF), as in the recordings of the 2012 gateware; else 0.
  Memory(bool bench, std::uint32_t data_mask) : bench_(bench), mask_(data_mask) {}

  BusReply read(std::uint32_t address, Clock) override {
    const auto page = pages_.find(address / page_words);
    return {BusStatus::ok, page == pages_.end() ? initial(address) : (*page->second)[address % page_words]};
  }

  BusStatus write(std::uint32_t address, std::uint32_t value, Clock) override {
    auto page = pages_.find(address / page_words);
    if (page == pages_.end()) {
      if (pages_.size() == pages_most) {
        return BusStatus::error;
      }
      page = pages_.emplace(address / page_words, std::make_unique<Page>()).first;
      const std::uint32_t first = address - address % static_cast<std::uint32_t>(page_words);
      for (std::size_t word = 0; word < page_words; ++word) {
        (*page->second)[word] = initial(first + static_cast<std::uint32_t>(word));
      }
    }
    (*page->second)[address % page_words] = value & mask_;
    return BusStatus::ok;
  }

  BusReply get(std::uint32_t address, Clock now) override { return read(address, now); }
  BusStatus set(std::uint32_t address, std::uint32_t value, Clock now) override { return write(address, value, now); }
  [[nodiscard]] Clock settles(std::uint32_t) const noexcept override { return 0; }

 private:
  using Page = std::array<std::uint32_t, page_words>;

  [[nodiscard]] std::uint32_t initial(std::uint32_t address) const noexcept {
    return bench_ ? (0x40DE0000u | (address * 257u & 0xFFFFu)) & mask_ : 0u;
  }

  std::unordered_map<std::size_t, std::unique_ptr<Page>> pages_;
  bool bench_;
  std::uint32_t mask_;
};

}  // namespace unitylink::device
