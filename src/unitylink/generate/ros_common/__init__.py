# SPDX-License-Identifier: BSD-3-Clause
"""What the packages of ROS 1 and ROS 2 share."""
