// SPDX-License-Identifier: BSD-3-Clause
#pragma once
#include <cstdio>
#include <string>
namespace rclcpp {
struct Logger {
  std::string name;
};
inline Logger get_logger(const std::string& name) { return {name}; }
}  // namespace rclcpp
#define RCLCPP_INFO(logger, ...) \
  (std::fprintf(stderr, "%s: ", (logger).name.c_str()), std::fprintf(stderr, __VA_ARGS__), std::fputc('\n', stderr))
#define RCLCPP_WARN RCLCPP_INFO
#define RCLCPP_ERROR RCLCPP_INFO
