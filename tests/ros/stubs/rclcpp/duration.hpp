// SPDX-License-Identifier: BSD-3-Clause
#pragma once
namespace rclcpp {
class Duration {};
}  // namespace rclcpp
