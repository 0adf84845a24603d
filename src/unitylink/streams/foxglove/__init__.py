# SPDX-License-Identifier: BSD-3-Clause
"""A server for Foxglove: its WebSocket protocol, behind the gate of the robot."""
