// SPDX-License-Identifier: BSD-3-Clause
// Ours: how the stub of a handle begins with a number of its type, and shows it. The genuine one has no such header.
#pragma once
#include <cmath>
#include <type_traits>
namespace hardware_interface {
namespace stub {
template <typename T>
const char* type_name() {
  if constexpr (std::is_same_v<T, double>) return "double";
  if constexpr (std::is_same_v<T, float>) return "float32";
  if constexpr (std::is_same_v<T, bool>) return "bool";
  if constexpr (std::is_same_v<T, std::uint8_t>) return "uint8";
  if constexpr (std::is_same_v<T, std::int8_t>) return "int8";
  if constexpr (std::is_same_v<T, std::uint16_t>) return "uint16";
  if constexpr (std::is_same_v<T, std::int16_t>) return "int16";
  if constexpr (std::is_same_v<T, std::uint32_t>) return "uint32";
  if constexpr (std::is_same_v<T, std::int32_t>) return "int32";
  return "";
}
template <typename T, typename Types>
bool begin(Types& value, const std::string& type) {
  if constexpr (!std::is_same_v<T, std::monostate>) {
    if (type != type_name<T>()) return false;
    value = std::is_floating_point_v<T> ? static_cast<T>(std::nan("")) : T{};
    return true;
  }
  return false;
}
template <typename... T>
bool begin_any(std::variant<T...>& value, const std::string& type) {
  return (begin<T>(value, type) || ...);
}
}  // namespace stub
template <typename Types>
void Handle::begin() {
  if (!stub::begin_any(value_, type_))
    throw std::runtime_error("Invalid data type : '" + type_ + "' for interface : " + name_);
}
inline double Handle::as_double() const {
  return std::visit(
      [](auto number) {
        if constexpr (std::is_same_v<decltype(number), std::monostate>)
          return std::nan("");
        else
          return static_cast<double>(number);
      },
      value_);
}
}  // namespace hardware_interface
