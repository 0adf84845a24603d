// SPDX-License-Identifier: BSD-3-Clause
// The three checksums of a classic datalink: CRC-8 with any polynomial, the 2012 gateware's XOR of bytes, or none.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "unitylink/protocol.hpp"

namespace unitylink {

// One table per polynomial, made once. update() is one load and one XOR. There is no reflection and no final XOR. So
// the remainder over data and their checksum is 0, and the receiver checks this.
class Crc8 {
 public:
  constexpr explicit Crc8(std::uint8_t polynomial = protocol::crc8::polynomial) noexcept : polynomial_(polynomial) {
    for (unsigned value = 0; value < 256; ++value) {
      unsigned remainder = value;
      for (int bit = 0; bit < 8; ++bit) {
        remainder = (remainder & 0x80u) != 0 ? (remainder << 1) ^ polynomial : remainder << 1;
      }
      table_[value] = static_cast<std::uint8_t>(remainder);
    }
  }

  // The byte-wise XOR variant (a synthesis option of the 2012 gateware): the table is the identity.
  static constexpr Crc8 exclusive_or() noexcept {
    Crc8 sum(0);
    for (unsigned value = 0; value < 256; ++value) {
      sum.table_[value] = static_cast<std::uint8_t>(value);
    }
    return sum;
  }

  [[nodiscard]] constexpr std::uint8_t update(std::uint8_t sum, std::uint8_t byte) const noexcept {
    return table_[static_cast<std::uint8_t>(sum ^ byte)];
  }

  [[nodiscard]] constexpr std::uint8_t of(std::span<const std::uint8_t> data,
                                          std::uint8_t sum = protocol::crc8::initial) const noexcept {
    for (const std::uint8_t byte : data) {
      sum = update(sum, byte);
    }
    return sum;
  }

  [[nodiscard]] constexpr std::uint8_t polynomial() const noexcept { return polynomial_; }

 private:
  std::array<std::uint8_t, 256> table_{};
  std::uint8_t polynomial_;
};

}  // namespace unitylink
