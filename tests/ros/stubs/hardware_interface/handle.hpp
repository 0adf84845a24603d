// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <string>
#include <utility>
namespace hardware_interface {
class Handle {
 public:
  Handle(std::string prefix, std::string interface, double* value)
      : prefix_(std::move(prefix)), interface_(std::move(interface)), value_(value) {}
  std::string get_name() const { return prefix_ + "/" + interface_; }
  double get_value() const { return *value_; }
  void set_value(double value) { *value_ = value; }

 private:
  std::string prefix_, interface_;
  double* value_;
};
class StateInterface : public Handle {
  using Handle::Handle;
};
class CommandInterface : public Handle {
  using Handle::Handle;
};
}  // namespace hardware_interface
