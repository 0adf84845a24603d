// SPDX-License-Identifier: BSD-3-Clause
// The two CRCs of the framed protocol: CRC-16/MCRF4XX and CRC-32C. Both are reflected, without a final XOR. Eight
// tables process eight bytes at a time.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "unitylink/protocol.hpp"

namespace unitylink {

template <class Word, Word polynomial>
struct ReflectedCrc {
  // Adds one byte. The device does the same.
  [[nodiscard]] static constexpr Word update(Word sum, std::uint8_t byte) noexcept {
    return static_cast<Word>((sum >> 8) ^ tables[0][(sum ^ byte) & 0xFF]);
  }

  [[nodiscard]] static constexpr Word of(std::span<const std::uint8_t> data, Word sum) noexcept {
    const std::uint8_t* at = data.data();
    std::size_t left = data.size();
    for (; left >= 8; left -= 8, at += 8) {  // byte k of eight still has 7 - k zero bytes to pass through
      const std::uint32_t low = sum ^ (std::uint32_t{at[0]} | std::uint32_t{at[1]} << 8 | std::uint32_t{at[2]} << 16 |
                                       std::uint32_t{at[3]} << 24);
      sum = static_cast<Word>(tables[7][low & 0xFF] ^ tables[6][low >> 8 & 0xFF] ^ tables[5][low >> 16 & 0xFF] ^
                              tables[4][low >> 24] ^ tables[3][at[4]] ^ tables[2][at[5]] ^ tables[1][at[6]] ^
                              tables[0][at[7]]);
    }
    for (; left > 0; --left, ++at) {
      sum = update(sum, *at);
    }
    return sum;
  }

 private:
  using Tables = std::array<std::array<Word, 256>, 8>;

  static constexpr Tables make_tables() noexcept {
    Tables made{};
    for (unsigned value = 0; value < 256; ++value) {
      Word sum = static_cast<Word>(value);
      for (int bit = 0; bit < 8; ++bit) {
        sum = static_cast<Word>((sum & 1u) != 0 ? (sum >> 1) ^ polynomial : sum >> 1);
      }
      made[0][value] = sum;
    }
    for (std::size_t zeros = 1; zeros < made.size(); ++zeros) {
      for (unsigned value = 0; value < 256; ++value) {
        const Word sum = made[zeros - 1][value];
        made[zeros][value] = static_cast<Word>((sum >> 8) ^ made[0][sum & 0xFF]);
      }
    }
    return made;
  }

  static constexpr Tables tables = make_tables();
};

using Crc16 = ReflectedCrc<std::uint16_t, protocol::frame::crc16_polynomial>;
using Crc32c = ReflectedCrc<std::uint32_t, protocol::frame::crc32_polynomial>;

}  // namespace unitylink
