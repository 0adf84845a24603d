// SPDX-License-Identifier: BSD-3-Clause
// Without what ros2_control#3610 removes: the export by value, and on_init() with a HardwareInfo.
#pragma once
#include "hardware_interface/hardware_component_interface.hpp"
namespace hardware_interface {
class SystemInterface : public HardwareComponentInterface {
 public:
  return_type write(const rclcpp::Time& time, const rclcpp::Duration& period) override = 0;
};
}  // namespace hardware_interface
