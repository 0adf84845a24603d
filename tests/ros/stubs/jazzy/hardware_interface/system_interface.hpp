// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include "hardware_interface/hardware_component_interface.hpp"
namespace hardware_interface {
class SystemInterface : public HardwareComponentInterface {
 public:
  using HardwareComponentInterface::on_init;
  virtual CallbackReturn on_init(const HardwareInfo& hardware_info) {
    return info_ = hardware_info, CallbackReturn::SUCCESS;
  }
  [[deprecated]] virtual std::vector<StateInterface> export_state_interfaces() { return {}; }
  [[deprecated]] virtual std::vector<CommandInterface> export_command_interfaces() { return {}; }
  return_type write(const rclcpp::Time& time, const rclcpp::Duration& period) override = 0;
};
}  // namespace hardware_interface
