// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <stdexcept>
#include <string>
#include <unordered_map>
#include <vector>

#include "hardware_interface/handle.hpp"
#include "hardware_interface/hardware_info.hpp"
#include "hardware_interface/types/hardware_interface_return_values.hpp"
#include "rclcpp/duration.hpp"
#include "rclcpp/time.hpp"
#include "rclcpp_lifecycle/node_interfaces/lifecycle_node_interface.hpp"
namespace hardware_interface {
using CallbackReturn = rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface::CallbackReturn;
class HardwareComponentInterface : public rclcpp_lifecycle::node_interfaces::LifecycleNodeInterface {
 public:
  HardwareComponentInterface() = default;
  HardwareComponentInterface(const HardwareComponentInterface& other) = delete;
  virtual CallbackReturn on_init(const hardware_interface::HardwareComponentInterfaceParams& params) {
    return info_ = params.hardware_info, CallbackReturn::SUCCESS;
  }
  virtual std::vector<hardware_interface::InterfaceDescription> export_unlisted_state_interface_descriptions() {
    return {};
  }
  virtual std::vector<StateInterface::ConstSharedPtr> on_export_state_interfaces() {
    std::vector<StateInterface::ConstSharedPtr> made;
    for (const auto& one : all(export_unlisted_state_interface_descriptions(), &ComponentInfo::state_interfaces))
      made.push_back(states_[one.get_name()] = std::make_shared<StateInterface>(one));
    return made;
  }
  virtual std::vector<hardware_interface::InterfaceDescription> export_unlisted_command_interface_descriptions() {
    return {};
  }
  virtual std::vector<CommandInterface::SharedPtr> on_export_command_interfaces() {
    std::vector<CommandInterface::SharedPtr> made;
    for (const auto& one : all(export_unlisted_command_interface_descriptions(), &ComponentInfo::command_interfaces))
      made.push_back(commands_[one.get_name()] = std::make_shared<CommandInterface>(one));
    return made;
  }
  virtual return_type read(const rclcpp::Time& time, const rclcpp::Duration& period) = 0;
  virtual return_type write(const rclcpp::Time&, const rclcpp::Duration&) { return return_type::OK; }
  virtual const StateInterface::SharedPtr& get_state_interface_handle(const std::string& interface_name) const {
    return states_.at(interface_name);
  }
  template <typename T>
  bool set_state(const StateInterface::SharedPtr& interface_handle, const T& value, bool wait_until_set) {
    if (!interface_handle) throw std::runtime_error("State interface handle is null");
    return interface_handle->set_value(value, wait_until_set);
  }
  virtual const CommandInterface::SharedPtr& get_command_interface_handle(const std::string& interface_name) const {
    return commands_.at(interface_name);
  }
  template <typename T>
  bool set_command(const CommandInterface::SharedPtr& interface_handle, const T& value, bool wait_until_set) {
    if (!interface_handle) throw std::runtime_error("Command interface handle is null");
    return interface_handle->set_value(value, wait_until_set);
  }
  template <typename T>
  bool get_command(const CommandInterface::SharedPtr& interface_handle, T& command, bool wait_until_get) const {
    if (!interface_handle) throw std::runtime_error("Command interface handle is null");
    return interface_handle->get_value(command, wait_until_get);
  }

 protected:
  HardwareInfo info_;

 private:
  template <typename Member>
  std::vector<InterfaceDescription> all(std::vector<InterfaceDescription> made, Member member) const {
    for (const auto* parts : {&info_.joints, &info_.sensors, &info_.gpios}) {
      for (const auto& part : *parts)
        for (const auto& one : part.*member) made.emplace_back(part.name, one);
    }
    return made;
  }
  std::unordered_map<std::string, StateInterface::SharedPtr> states_;
  std::unordered_map<std::string, CommandInterface::SharedPtr> commands_;
};
}  // namespace hardware_interface
