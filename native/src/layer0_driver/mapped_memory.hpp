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

// What of a device is mapped.
struct MappedWindow {
  std::string path;
  std::uint64_t offset = 0;  // in bytes, and so is the size: multiples of 4
  std::uint64_t bytes = 0;
  std::uint32_t address_bytes = 0;
  std::uint32_t base_hz = 0;  // the frequency that divisors divide
};

// Word n is the 32 bits at byte 4 n of the window. Not thread-safe against close(); accesses of several threads may
// cross.
class MappedMemory {
 public:
  [[nodiscard]] static Outcome open(const MappedWindow& window, std::unique_ptr<MappedMemory>& memory);
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;
  ~MappedMemory() { close(); }

  [[nodiscard]] const MappedWindow& window() const noexcept { return window_; }
  // Not once it is closed.
  [[nodiscard]] bool has(std::uint32_t address) const noexcept { return address < words_; }
  [[nodiscard]] std::string beyond(std::uint32_t address) const;  // why it has not

  // Of addresses that it has.
  [[nodiscard]] std::uint32_t load(std::uint32_t address) const noexcept { return base_[address]; }
  void store(std::uint32_t address, std::uint32_t value) noexcept { base_[address] = value; }
  // One after the other, in order.
  void load(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values) const noexcept;
  // Loads words again until two passes in a row agree, so that all were so at one moment; false where none of `passes`
  // did, with the load before it.
  [[nodiscard]] bool settle(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values,
                            std::size_t passes) const noexcept;
  void close() noexcept;

 private:
  // Not mapped yet. It lets go of a mapping that it is given, whatever fails afterwards.
  MappedMemory(const MappedWindow& window, std::size_t length) : window_(window), length_(length) {}

  const MappedWindow window_;
  const std::size_t length_;
  void* mapping_ = nullptr;
  volatile std::uint32_t* base_ = nullptr;
  std::uint64_t words_ = 0;
};

}  // namespace unitylink
