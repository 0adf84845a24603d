# SPDX-License-Identifier: BSD-3-Clause
"""A robot's model in MuJoCo behind the registers: `plant=mujoco:robot.xml` (docs/mujoco.md)."""

from __future__ import annotations

from .film import Film, save_picture
from .plant import MujocoPlant

__all__ = ["Film", "MujocoPlant", "save_picture"]
