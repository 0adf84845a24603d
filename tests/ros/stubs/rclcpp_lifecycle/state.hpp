// SPDX-License-Identifier: BSD-3-Clause
#pragma once
namespace rclcpp_lifecycle {
class State {};
}  // namespace rclcpp_lifecycle
