// SPDX-License-Identifier: BSD-3-Clause
// Words of a device that the processor sees as memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "layer0_driver/status.hpp"

namespace unitylink {

// Word n is the 32 bits at byte 4 n of the window. Not thread-safe against close(); accesses of several threads may cross.
class MappedMemory {
 public:
  // Maps `bytes` of `path` from byte `offset` on, both multiples of 4.
  [[nodiscard]] static Outcome open(const std::string& path, std::uint64_t offset, std::uint64_t bytes, std::unique_ptr<MappedMemory>& memory);
  MappedMemory(const MappedMemory&) = delete;
  MappedMemory& operator=(const MappedMemory&) = delete;
  ~MappedMemory() { close(); }

  [[nodiscard]] std::size_t words() const noexcept { return words_; }
  [[nodiscard]] bool closed() const noexcept { return base_ == nullptr; }
  [[nodiscard]] Outcome read(std::uint32_t address, std::uint32_t& value) const;
  [[nodiscard]] Outcome write(std::uint32_t address, std::uint32_t value);
  // One after the other, in order.
  [[nodiscard]] Outcome read_many(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values) const;
  // Until two passes in a row agree, so that all words were so at one moment; `settled` is false where none of `passes` did.
  [[nodiscard]] Outcome read_settled(std::span<const std::uint32_t> addresses, std::span<std::uint32_t> values, std::size_t passes,
                                     bool& settled) const;
  void close() noexcept;

 private:
  MappedMemory(void* mapping, std::size_t length, volatile std::uint32_t* base, std::size_t words)
      : mapping_(mapping), length_(length), base_(base), words_(words) {}
  [[nodiscard]] Outcome check(std::uint32_t address) const;

  void* mapping_;
  std::size_t length_;
  volatile std::uint32_t* base_;
  std::size_t words_;
};

}  // namespace unitylink
