// SPDX-License-Identifier: BSD-3-Clause
// The part of rclcpp's public interface that the generated node uses. Nothing is sent anywhere.
#pragma once
#include <chrono>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <type_traits>

#include <rcl_interfaces/msg/parameter_descriptor.hpp>

#include "rclcpp/logging.hpp"
namespace rclcpp {
inline void init(int, char**) {}
inline void shutdown() {}
struct Clock {};
class QoS {
 public:
  explicit QoS(std::size_t) {}
  QoS& best_effort() { return *this; }
};
template <typename M>
class Publisher {
 public:
  using SharedPtr = std::shared_ptr<Publisher<M>>;
  void publish(const M&) {}
  std::size_t get_subscription_count() const { return 0; }
};
class SubscriptionBase {
 public:
  using SharedPtr = std::shared_ptr<SubscriptionBase>;
};
class ServiceBase {
 public:
  using SharedPtr = std::shared_ptr<ServiceBase>;
};
class TimerBase {};
enum class CallbackGroupType { MutuallyExclusive, Reentrant };
class CallbackGroup {
 public:
  using SharedPtr = std::shared_ptr<CallbackGroup>;
};
struct SubscriptionOptions {
  CallbackGroup::SharedPtr callback_group;
};
class Node {
 public:
  using SharedPtr = std::shared_ptr<Node>;
  explicit Node(const std::string&) {}
  template <typename M>
  typename Publisher<M>::SharedPtr create_publisher(const std::string&, const QoS&) {
    return std::make_shared<Publisher<M>>();
  }
  template <typename M, typename F>
  SubscriptionBase::SharedPtr create_subscription(const std::string&, const QoS&, F&&, const SubscriptionOptions&) {
    static_assert(std::is_invocable_v<F, std::shared_ptr<const M>>);
    return std::make_shared<SubscriptionBase>();
  }
  template <typename S, typename F>
  ServiceBase::SharedPtr create_service(const std::string&, F&&) {
    static_assert(std::is_invocable_v<F, std::shared_ptr<typename S::Request>, std::shared_ptr<typename S::Response>>);
    return std::make_shared<ServiceBase>();
  }
  template <typename F>
  std::shared_ptr<TimerBase> create_wall_timer(std::chrono::milliseconds, F&&, CallbackGroup::SharedPtr = nullptr) {
    return std::make_shared<TimerBase>();
  }
  CallbackGroup::SharedPtr create_callback_group(CallbackGroupType) { return std::make_shared<CallbackGroup>(); }
  template <typename T>
  T declare_parameter(const std::string&, const T& standard, const rcl_interfaces::msg::ParameterDescriptor&) {
    return standard;
  }
  Logger get_logger() const { return {"unitylink"}; }
  std::shared_ptr<Clock> get_clock() { return std::make_shared<Clock>(); }
  const char* get_fully_qualified_name() const { return "/unitylink"; }
};
struct ExecutorOptions {};
namespace executors {
class MultiThreadedExecutor {
 public:
  MultiThreadedExecutor(const ExecutorOptions&, std::size_t) {}
  void add_node(const Node::SharedPtr&) {}
  void spin() {}
};
}  // namespace executors
}  // namespace rclcpp
#define RCLCPP_FATAL RCLCPP_INFO
#define RCLCPP_WARN_THROTTLE(logger, clock, ms, ...) ((void)(clock), (void)(ms), RCLCPP_INFO(logger, __VA_ARGS__))
