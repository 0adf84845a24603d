# SPDX-License-Identifier: BSD-3-Clause
"""The plan of typed objects that C, C++ and Rust share."""

from __future__ import annotations

from .dialect import CPP, RUST, C
from .names import Names, members, snake
from .plan import ObjectsPlan
from .planner import plan_objects
from .style import Style

__all__ = ["CPP", "RUST", "C", "Names", "ObjectsPlan", "Style", "members", "plan_objects", "snake"]
