# SPDX-License-Identifier: BSD-3-Clause
"""What a generated package of LeRobot works with (docs/lerobot.md). LeRobot itself is not needed here.

>>> from unitylink.lerobot import Follower
>>> robot = Follower("sim:arm.ul", ArmRobot, ("j1.position",), ("j1.target",))     # doctest: +SKIP
"""

from __future__ import annotations

from .follower import Follower
from .leader import Leader

__all__ = ["Follower", "Leader"]
