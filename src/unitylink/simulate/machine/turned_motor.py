# SPDX-License-Identifier: BSD-3-Clause
"""A DC motor whose shaft belongs to something else: a joint of a model that has its own physics."""

from __future__ import annotations

import math

from .checks import check_number
from .dc_motor_data import DcMotorData
from .gear import Gear

_DIRECT = Gear()


class TurnedMotor:
    """The winding of a motor, and the torque that it gives through a gear. `Bridge` drives it.

        motor = TurnedMotor(MOTORS["maxon RE 40"], Gear(ratio=43))
        motor.speed_rad_s = speed_of_the_joint   # in each step
        bridge.drive(motor, self.period_s)
        torque_nm = motor.taken_torque_nm()      # the mean since the last call, at the output of the gear

    In a step the speed is constant, and the current is the exact solution. Inertia, friction and play are
    those of the joint: `inertia_kg_m2`, `friction_nm` and `damping_nm_s` are what motor and gear add there.
    """

    def __init__(self, data: DcMotorData, gear: Gear = _DIRECT) -> None:
        self.data, self.gear = data, gear
        self.current_a = 0.0
        self.speed_rad_s = 0.0
        self._charge = self._seconds = 0.0

    @property
    def inertia_kg_m2(self) -> float:
        return (self.data.inertia_kg_m2 + self.gear.inertia_kg_m2) * self.gear.torque_ratio * self.gear.ratio

    @property
    def friction_nm(self) -> float:
        return self.data.friction_nm * self.gear.torque_ratio

    @property
    def damping_nm_s(self) -> float:
        return self.data.damping_nm_s * self.gear.torque_ratio * self.gear.ratio

    def step(
        self, volts: float | None, seconds: float, *, series_ohm: float = 0.0, supply_v: float = 0.0
    ) -> None:
        """Let some time pass at a voltage. Without one (None) its wires are open, as with `DcMotor`."""
        what = f"motor {self.data.name}"
        check_number(what, "speed_rad_s", self.speed_rad_s, remedy="look at what the plant computes")
        ohm = self.data.resistance_ohm + series_ohm
        back_v = self.data.constant * self.speed_rad_s * self.gear.ratio
        late_s = self.data.inductance_h(ohm) / ohm
        before = self.current_a
        self._seconds += seconds
        if volts is not None:
            self._flow((volts - back_v) / ohm, late_s, seconds)
        elif before != 0:  # against the supply, through the diodes, until it ends
            rest = (-math.copysign(supply_v, before) - back_v) / ohm
            ends_s = late_s * math.log(1 - before / rest) if rest * before < 0 else math.inf
            self._flow(rest, late_s, min(seconds, ends_s))
            if ends_s <= seconds:
                self.current_a = 0.0

    def _flow(self, rest_a: float, late_s: float, seconds: float) -> None:
        """Bring the current nearer to where it would rest."""
        gone = -math.expm1(-seconds / late_s)
        self._charge += rest_a * seconds + (self.current_a - rest_a) * late_s * gone
        self.current_a += (rest_a - self.current_a) * gone

    def taken_torque_nm(self) -> float:
        """Return the mean torque since the last call, with what the gear takes of it."""
        mean_a = self._charge / self._seconds if self._seconds > 0 else self.current_a
        self._charge = self._seconds = 0.0
        return self.gear.torque_behind(self.data.constant * mean_a, self.speed_rad_s)
