# SPDX-License-Identifier: BSD-3-Clause
"""Seven joints on a virtual board: `sim:pa10.ul?plant=plant.py`."""

from __future__ import annotations

from unitylink.simulate.plants import Joint, ServoNames, ServoPlant

JOINT = Joint("joint", "rad", -3.2, 3.2, speed_limit=6.0, acceleration_limit=40.0)
PUBLISHED = ServoNames("cpos", "pos_sp", "spd", "spd_sp")  # the names in pa10.ul
OURS = ServoNames("pos", "target", "speed", "limit")  # the names in pa10_pair.ul


class Plant(ServoPlant):
    """Every joint follows its set-point within its speed limit. A count of pa10.ul is 0.1 mrad."""

    def __init__(self) -> None:
        super().__init__([PUBLISHED, OURS], JOINT, step=0.0001)
