// SPDX-License-Identifier: BSD-3-Clause
// The values that FTDI's chips expect, from their data sheets and application notes. tests/unit/link/test_ftdi.py tests
// the driver as a whole.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "layer0_driver/ftdi_chip.hpp"

using namespace unitylink;

TEST_CASE("status bytes stand at the head of every packet, short ones and empty ones too") {
  for (const std::size_t packet : {64u, 512u}) {
    for (std::size_t length = 0; length < 3 * packet; ++length) {
      std::vector<std::uint8_t> bytes, wanted;
      for (std::size_t index = 0; index < length; ++index) {
        const bool status = index % packet < 2;
        bytes.push_back(status ? 0xFF : static_cast<std::uint8_t>(index % 251));
        if (!status) {
          wanted.push_back(bytes.back());
        }
      }
      const std::size_t left = ftdi::strip_status(bytes, packet);
      bytes.resize(left);
      REQUIRE(bytes == wanted);
    }
  }
}

TEST_CASE("divisors are those of AN_120 and AN_232B-05") {
  const ftdi::Chip& r = *ftdi::chip_of(0x0600);
  const ftdi::Chip& h = *ftdi::chip_of(0x0700);
  CHECK(ftdi::divisor_of(r, 9600).value == 0x4138);  // 312.5
  CHECK(ftdi::divisor_of(r, 300).value == 0x2710);   // 10000
  CHECK(ftdi::divisor_of(r, 3'000'000).value == 0x0000);
  CHECK(ftdi::divisor_of(r, 2'000'000).value == 0x0001);
  CHECK(ftdi::divisor_of(r, 1'000'000).value == 0x0003);
  CHECK(ftdi::divisor_of(h, 12'000'000).value == 0x0000);
  CHECK(ftdi::divisor_of(h, 12'000'000).index == 0x0200);  // the 12 MHz clock; the channel is in the low byte
  CHECK(ftdi::divisor_of(h, 3'000'000).value == 0x0004);
  CHECK(ftdi::divisor_of(h, 115'200).value == 0xC068);  // 104.125
  for (std::uint32_t baud_hz = 1000; baud_hz <= 1'000'000; baud_hz += 777) {
    for (const ftdi::Chip* chip : {&r, &h}) {
      CHECK(std::abs(static_cast<double>(ftdi::divisor_of(*chip, baud_hz).baud_hz) / baud_hz - 1) < 0.03);
    }
  }
  CHECK(ftdi::chip_of(0x1234) == nullptr);
}
