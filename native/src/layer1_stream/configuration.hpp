// SPDX-License-Identifier: BSD-3-Clause
// What a device reports about itself in its CNF reply.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "layer1_stream/crc8.hpp"

namespace unitylink {

struct Configuration {
  std::uint32_t address_bytes = 0;
  std::uint32_t data_bytes = 0;
  std::uint32_t read_many = 0;     // most words of one RM; 0: no RM
  std::uint32_t publish_mode = 0;  // 0 none, 1 requests before publishing, 2 publishing before requests
  std::uint64_t base_hz = 0;
  std::uint32_t groups = 0;
  std::uint32_t group_size = 0;  // as reported; 2012 gateware can hold one less
  std::uint32_t rate_bytes = 0;
  bool discovered = false;  // reported by the device, not given in the URL

  friend bool operator==(const Configuration&, const Configuration&) = default;
};

// Reads the eight comma-separated fields. 2012 gateware has three defects here:
// - it sends a value byte 0x2C as a bare ',', so the length of the frequency field is found by trying;
// - such a byte is not in its checksum;
// - it sends a frequency of exactly 256**n as n zero bytes.
// No other reply has bytes that are not digits: a 2C in their data is sent as "2c", and counts. These defects are
// accepted only if `of_2012`, because a bad wire could make them from a good reply. For a checked reply, `checksum` is
// compared over "CNF" and the decoded bytes. nullopt: there is no legal reading.
[[nodiscard]] std::optional<Configuration> parse_configuration(std::string_view fields, const Crc8& sum,
                                                               std::optional<std::uint8_t> checksum,
                                                               bool of_2012 = true) noexcept;
// Whether 2012 gateware would send a byte of this configuration as ','.
[[nodiscard]] bool has_comma_byte(const Configuration& configuration) noexcept;

}  // namespace unitylink
