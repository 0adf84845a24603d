// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <vector>

#include "hardware_interface/handle.hpp"
#include "hardware_interface/hardware_info.hpp"
#include "hardware_interface/types/hardware_interface_return_values.hpp"
#include "rclcpp/duration.hpp"
#include "rclcpp/time.hpp"
#include "rclcpp_lifecycle/node_interfaces/lifecycle_node_interface.hpp"
namespace hardware_interface {
using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
class SystemInterface : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface {
 public:
  SystemInterface() = default;
  SystemInterface(const SystemInterface& other) = delete;
  virtual CallbackReturn on_init(const HardwareInfo& hardware_info) {
    return info_ = hardware_info, CallbackReturn::SUCCESS;
  }
  virtual std::vector<StateInterface> export_state_interfaces() = 0;
  virtual std::vector<CommandInterface> export_command_interfaces() = 0;
  virtual return_type read(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;
  virtual return_type write(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;

 protected:
  HardwareInfo info_;
};
}  // namespace hardware_interface
