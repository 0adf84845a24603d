// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <limits>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <stdexcept>
#include <string>

#include "hardware_interface/hardware_info.hpp"
namespace hardware_interface {
class Handle {
 public:
  explicit Handle(const InterfaceDescription& interface_description)
      : name_(interface_description.get_name()), type_(interface_description.interface_info.data_type) {
    begin<HANDLE_DATATYPE>();
  }
  const std::string& get_name() const { return name_; }
  HandleDataType get_data_type() const { return HandleDataType(type_); }
  std::shared_mutex& get_mutex() const { return mutex_; }
  template <typename T>
  bool get_value(T& value, bool wait_for_lock) const {
    std::shared_lock<std::shared_mutex> lock(mutex_, std::defer_lock);
    if (!locked(lock, wait_for_lock)) return false;
    if (!std::holds_alternative<T>(value_)) throw std::runtime_error("Invalid data type of " + name_);
    return value = std::get<T>(value_), true;
  }
  template <typename T>
  bool set_value(const T& value, bool wait_for_lock) {
    std::unique_lock<std::shared_mutex> lock(mutex_, std::defer_lock);
    if (!locked(lock, wait_for_lock)) return false;
    if (!std::holds_alternative<T>(value_)) throw std::runtime_error("Invalid data type of " + name_);
    return value_ = value, true;
  }
  double as_double() const;  // ours

 private:
  template <typename Lock>
  static bool locked(Lock& lock, bool wait) {
    return wait ? lock.lock(), true : lock.try_lock();
  }
  // The first number of its type: NaN for a double and a float.
  template <typename Types>
  void begin();
  std::string name_, type_;
  HANDLE_DATATYPE value_;
  mutable std::shared_mutex mutex_;
};
class StateInterface : public Handle {
 public:
  using Handle::Handle;
  using SharedPtr = std::shared_ptr<StateInterface>;
  using ConstSharedPtr = std::shared_ptr<const StateInterface>;
};
class CommandInterface : public Handle {
 public:
  using Handle::Handle;
  using SharedPtr = std::shared_ptr<CommandInterface>;
};
}  // namespace hardware_interface
#include "hardware_interface/handle_numbers.hpp"
