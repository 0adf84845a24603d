// SPDX-License-Identifier: BSD-3-Clause
// The part of hardware_info.hpp that is the same in all releases. The genuine one has no such header.
#pragma once
#include <string>
#include <unordered_map>
#include <vector>
namespace hardware_interface {
struct InterfaceInfo {
  std::string name;
  std::string min;
  std::string max;
  std::string initial_value;
  std::string data_type = "double";
  int size;
};
struct ComponentInfo {
  std::string name;
  std::string type;
  std::vector<InterfaceInfo> command_interfaces;
  std::vector<InterfaceInfo> state_interfaces;
  std::unordered_map<std::string, std::string> parameters;
};
struct HardwareInfo {
  std::string name;
  std::string type;
  std::unordered_map<std::string, std::string> hardware_parameters;
  std::vector<ComponentInfo> joints;
  std::vector<ComponentInfo> sensors;
  std::vector<ComponentInfo> gpios;
};
}  // namespace hardware_interface
