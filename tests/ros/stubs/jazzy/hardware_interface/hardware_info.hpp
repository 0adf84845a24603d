// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdint>
#include <string>
#include <variant>

#include "hardware_interface/component_info.hpp"
namespace hardware_interface {
using HANDLE_DATATYPE = std::variant<std::monostate, double, bool>;
class HandleDataType {
 public:
  explicit HandleDataType(const std::string& data_type) : text_(data_type) {}
  std::string to_string() const { return text_; }

 private:
  std::string text_;
};
struct InterfaceDescription {
  InterfaceDescription(const std::string& prefix_name_in, const InterfaceInfo& interface_info_in)
      : prefix_name(prefix_name_in), interface_info(interface_info_in) {}
  std::string prefix_name;
  InterfaceInfo interface_info;
  std::string get_name() const { return prefix_name + "/" + interface_info.name; }
};
struct HardwareComponentInterfaceParams {
  HardwareInfo hardware_info;
};
}  // namespace hardware_interface
