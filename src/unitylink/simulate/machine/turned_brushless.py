# SPDX-License-Identifier: BSD-3-Clause
"""A brushless motor whose rotor belongs to something else: a joint of a model that has its own physics."""

from __future__ import annotations

from .brushless import Brushless
from .brushless_data import BrushlessData
from .gear import Gear

_DIRECT = Gear()


class TurnedBrushless(Brushless):
    """The windings of a motor, and the torque that they give through a gear. `Inverter` drives it.

        motor = TurnedBrushless(BRUSHLESS["GBM2804H-100T"])
        motor.turn(angle_of_the_joint, speed_of_the_joint)  # in each step
        inverter.drive(motor, self.period_s)
        torque_nm = motor.taken_torque_nm()                 # the mean since the last call, behind the gear

    In a step the speed is constant. Inertia and friction are those of the joint: `inertia_kg_m2` and
    `friction_nm` are what motor and gear add there.
    """

    def __init__(self, data: BrushlessData, gear: Gear = _DIRECT) -> None:
        super().__init__(data)
        self.gear = gear
        self._impulse = self._seconds = 0.0
        self.damping_nm_s = 0.0  # all of its friction is the same at each speed

    @property
    def inertia_kg_m2(self) -> float:
        return (
            (self.data.rotor_inertia_g_cm2 + self.gear.inertia_g_cm2)
            * 1e-7
            * self.gear.torque_ratio
            * self.gear.ratio
        )

    @property
    def friction_nm(self) -> float:
        return self.data.friction_mnm / 1000 * self.gear.torque_ratio

    def turn(self, angle_rad: float, speed_rad_s: float) -> None:
        """Tell where the output of the gear is, and how fast it turns."""
        self.angle_rad, self.speed_rad_s = angle_rad * self.gear.ratio, speed_rad_s * self.gear.ratio

    def taken_torque_nm(self) -> float:
        """Return the mean torque since the last call, with what the gear takes of it."""
        mean = self._impulse / self._seconds if self._seconds > 0 else self.torque_nm
        self._impulse = self._seconds = 0.0
        return self.gear.torque_behind(mean, self.speed_rad_s)

    def _move(self, torque: float, seconds: float) -> None:
        self._impulse += torque * seconds
        self._seconds += seconds
        self.angle_rad += self.speed_rad_s * seconds
