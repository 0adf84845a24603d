# SPDX-License-Identifier: BSD-3-Clause
"""Eighteen servos on a virtual board: `sim:walker18.ul?plant=plant.py`."""

from __future__ import annotations

from unitylink.simulate.plants import Joint, ServoNames, ServoPlant

SERVO = Joint("servo", "rad", -2.6, 2.6, speed_limit=8.0, acceleration_limit=160.0)
NAMES = [ServoNames(name, f"{name}_sp") for name in ("hip", "knee", "foot")]


class Plant(ServoPlant):
    """A joint behind every hip, knee and foot. A count in the published language is 1 mrad."""

    def __init__(self) -> None:
        super().__init__(NAMES, SERVO, step=0.001)
