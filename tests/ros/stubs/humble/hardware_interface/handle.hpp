// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
namespace hardware_interface {
class ReadOnlyHandle {
 public:
  ReadOnlyHandle(const std::string& prefix_name, const std::string& interface_name, double* value_ptr = nullptr)
      : prefix_name_(prefix_name), interface_name_(interface_name), value_ptr_(value_ptr) {}
  const std::string get_name() const { return prefix_name_ + "/" + interface_name_; }
  double get_value() const { return *value_ptr_; }

 protected:
  std::string prefix_name_, interface_name_;
  double* value_ptr_;
};
class ReadWriteHandle : public ReadOnlyHandle {
 public:
  using ReadOnlyHandle::ReadOnlyHandle;
  void set_value(double value) { *value_ptr_ = value; }
};
class StateInterface : public ReadOnlyHandle {
 public:
  using ReadOnlyHandle::ReadOnlyHandle;
};
class CommandInterface : public ReadWriteHandle {
 public:
  CommandInterface(const CommandInterface& other) = delete;
  CommandInterface(CommandInterface&& other) = default;
  using ReadWriteHandle::ReadWriteHandle;
};
}  // namespace hardware_interface
