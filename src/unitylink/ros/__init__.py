# SPDX-License-Identifier: BSD-3-Clause
"""A robot as a ROS node: its interface in ROS, and the node that all front ends use."""

from __future__ import annotations

from .interface import Constant, Field, Interface, Joint, Message, Topic
from .mapping import plan_interface

__all__ = ["Constant", "Field", "Interface", "Joint", "Message", "Topic", "plan_interface"]
