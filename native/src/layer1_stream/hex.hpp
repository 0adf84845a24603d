// SPDX-License-Identifier: BSD-3-Clause
// Converts hex digits to values and back, with tables, because the classic protocol spends most of its time here.
#pragma once

#include <array>
#include <cstdint>

namespace unitylink {

inline constexpr std::uint8_t not_a_digit = 0xFF;

namespace detail {

constexpr std::array<std::uint8_t, 256> make_digit_values() noexcept {
  std::array<std::uint8_t, 256> values{};
  for (auto& value : values) {
    value = not_a_digit;
  }
  for (unsigned digit = 0; digit < 10; ++digit) {
    values['0' + digit] = static_cast<std::uint8_t>(digit);
  }
  for (unsigned digit = 0; digit < 6; ++digit) {
    values['a' + digit] = values['A' + digit] = static_cast<std::uint8_t>(10 + digit);
  }
  return values;
}

}  // namespace detail

inline constexpr auto digit_values = detail::make_digit_values();
inline constexpr char lower_digits[] = "0123456789abcdef";  // what gateware sends
inline constexpr char upper_digits[] = "0123456789ABCDEF";  // what hosts send

// The value of one hex digit of either case, or not_a_digit.
[[nodiscard]] constexpr std::uint8_t digit_value(char digit) noexcept {
  return digit_values[static_cast<std::uint8_t>(digit)];
}

}  // namespace unitylink
