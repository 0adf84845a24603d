# SPDX-License-Identifier: BSD-3-Clause
"""A gear between a motor and what it moves."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .checks import check_number, check_positive, check_share


@dataclass(frozen=True)
class Gear:
    """Turns of the motor for one of the output, what comes through of its torque, and the play in it.

    `backlash_deg` is the whole play, at the output. `inertia_g_cm2` is that of the gear, at the motor.
    `source` says where the figures are from.
    """

    ratio: float = 1.0
    efficiency: float = 1.0
    backlash_deg: float = 0.0
    inertia_g_cm2: float = 0.0
    source: str = ""

    def __post_init__(self) -> None:
        check_positive(
            "gear", "ratio", self.ratio, remedy="a gear that turns the other way has wires swapped"
        )
        check_share("gear", "efficiency", self.efficiency, above=True, remedy="0.7 means 70 %")
        check_number("gear", "backlash_deg", self.backlash_deg, least=0.0)
        check_number("gear", "inertia_g_cm2", self.inertia_g_cm2, least=0.0)

    @property
    def backlash_rad(self) -> float:
        return math.radians(self.backlash_deg)

    @property
    def inertia_kg_m2(self) -> float:
        return self.inertia_g_cm2 * 1e-7

    @property
    def torque_ratio(self) -> float:
        """What a torque of the motor is at the output, if the motor drives."""
        return self.ratio * self.efficiency

    def torque_behind(self, torque_nm: float, speed_rad_s: float) -> float:
        """Return what a torque of the motor is at the output. The gear takes its part of the power.

        The speed may be that of either side.
        """
        behind_nm = torque_nm * self.ratio
        drives = behind_nm * speed_rad_s >= 0
        return behind_nm * self.efficiency if drives else behind_nm / self.efficiency
