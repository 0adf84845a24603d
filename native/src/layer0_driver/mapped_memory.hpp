// SPDX-License-Identifier: BSD-3-Clause
// Words of a device that the processor sees as memory: a UIO device, a BAR of a PCIe card, the bridge of an SoC, a
// file. Every access is one aligned 32-bit load or store. No compiler divides, joins or omits it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "layer0_driver/status.hpp"

namespace unitylink {

// The part of a device that is mapped.
struct MappedWindow {
  std::string path;
  std::uint64_t offset = 0;  // offset and size are in bytes, and multiples of 4
  std::uint64_t bytes = 0;
  std::uint32_t address_bytes = 0;
  std::uint32_t base_hz = 0;  // the base frequency: a group is polled at base_hz / divisor
};

// Word n is the 32 bits at byte 4 n of the window. Several threads may access words at the same time, but not during
// close().
class MappedMemory {
 public:
  [[nodiscard]] static Outcome open(const MappedWindow& window, std::unique_ptr<MappedMemory>& memory);
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;
  ~MappedMemory() { close(); }

  [[nodiscard]] const MappedWindow& window() const noexcept { return window_; }
  // False for every address after close().
  [[nodiscard]] bool has(std::uint32_t address) const noexcept { return address < words_; }
  [[nodiscard]] std::string beyond(std::uint32_t address) const;  // the error text for an address beyond it

  // For addresses with has(address) only.
  [[nodiscard]] std::uint32_t load(std::uint32_t address) const noexcept { return base_[address]; }
  void store(std::uint32_t address, std::uint32_t value) noexcept { base_[address] = value; }
  // Loads one word after the other, in this order.
  void load(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values) const noexcept;
  // `values` are the result of an earlier load. Loads the words again until two loads in a row are equal: then the
  // words had these values at one moment. Returns false if this does not happen within `passes` loads, the first one
  // included.
  [[nodiscard]] bool settle(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                            std::size_t passes) const noexcept;
  void close() noexcept;

 private:
  // Nothing is mapped yet. Once mapping_ is set, the destructor releases it.
  MappedMemory(const MappedWindow& window, std::size_t length) : window_(window), length_(length) {}

  const MappedWindow window_;
  const std::size_t length_;
  void* mapping_ = nullptr;
  volatile std::uint32_t* base_ = nullptr;
  std::uint64_t words_ = 0;
};

}  // namespace unitylink
