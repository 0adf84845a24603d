// SPDX-License-Identifier: BSD-3-Clause
// What a device says about itself in its CNF reply.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "layer1_stream/crc8.hpp"

namespace unitylink {

struct Configuration {
  std::uint32_t address_bytes = 0;
  std::uint32_t data_bytes = 0;
  std::uint32_t read_many = 0;     // words in one RM, 0: no RM
  std::uint32_t publish_mode = 0;  // 0 none, 1 requests before publishing, 2 publishing before requests
  std::uint64_t base_hz = 0;
  std::uint32_t groups = 0;
  std::uint32_t group_size = 0;    // as advertised; 2012 gateware can hold one less
  std::uint32_t rate_bytes = 0;
  bool discovered = false;         // told by the device, not by the URL

  friend bool operator==(const Configuration&, const Configuration&) = default;
};

// Reads the eight comma-separated fields. 2012 gateware has three defects here: a value byte 0x2C is sent as a bare ',', so the
// length of the frequency field is found by trying; such a byte is not in its checksum; and a frequency of exactly 256**n is
// sent as n zero bytes. It is the only reply with bytes that are no digits: a 2C in the data of all others is "2c", and counts.
// All that is read only where `of_2012`: what a bad wire makes of a reply without it must not pass for one with it.
// `checksum` is compared over "CNF" and the decoded bytes when the reply was a checked one. nullopt: no legal reading.
[[nodiscard]] std::optional<Configuration> parse_configuration(std::string_view fields, const Crc8& sum,
                                                               std::optional<std::uint8_t> checksum, bool of_2012 = true) noexcept;
// Whether 2012 gateware has a byte of it sent as ','.
[[nodiscard]] bool has_comma_byte(const Configuration& configuration) noexcept;

}  // namespace unitylink
