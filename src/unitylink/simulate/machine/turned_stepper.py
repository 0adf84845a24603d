# SPDX-License-Identifier: BSD-3-Clause
"""A stepper motor whose shaft belongs to something else: a joint of a model that has its own physics."""

from __future__ import annotations

import math
from typing import NamedTuple

from unitylink.errors import ValueRangeError

from .checks import check_positive
from .stepper import Stepper, StepperData
from .supply import Supply

_SWING_MOST = 1.2  # for each time step of the model in a period; with 2 its swing just does not build up


class TurnedShaft(NamedTuple):
    """A joint at the begin of a step. `load_nm` is what it must overcome to keep its speed."""

    angle_rad: float
    speed_rad_s: float
    inertia_kg_m2: float
    load_nm: float


class TurnedStepper(Stepper):
    """The magnets and windings of a stepper with its driver, and the torque that they give to a joint.

        stepper = TurnedStepper(STEPPERS["17HS19-2004S1"], Supply(24.0), microsteps=16, ratio=5)
        torque_nm = stepper.give(steps, self.period_s, TurnedShaft(angle, speed, inertia, load))

    `ratio` is the turns of the motor for one of the joint. In a step the stepper moves what is at the joint
    with its torque and its friction, as `Stepper` does; what it gives is the mean torque of that. So a field
    as stiff as that of its magnets may be felt once a millisecond only.
    """

    def __init__(
        self,
        data: StepperData,
        supply: Supply,
        *,
        microsteps: int = 16,
        current_a: float | None = None,
        ratio: float = 1.0,
    ) -> None:
        super().__init__(data, supply, microsteps=microsteps, current_a=current_a)
        self.ratio = check_positive(self._what, "ratio", ratio)

    @property
    def inertia_kg_m2(self) -> float:
        """What its rotor adds at the joint."""
        return self.data.rotor_inertia_g_cm2 * 1e-7 * self.ratio**2

    def swing_rad_s(self, inertia_kg_m2: float) -> float:
        """Return how fast the joint swings in the field, with its own inertia and that of the rotor."""
        constant, detent = self.data.constant, self.data.detent_torque_ncm / 100
        stiff = self.data.pole_pairs * (constant * self._amplitude + 4 * detent)
        return self.ratio * math.sqrt(stiff / inertia_kg_m2)

    def check_period(self, inertia_kg_m2: float, period_s: float, steps: int) -> None:
        """Raise ValueRangeError if a joint swings too fast for a period of so many time steps of its
        model."""
        turned = self.swing_rad_s(inertia_kg_m2) * period_s
        if turned >= math.pi or turned * math.tan(turned / 2) > _SWING_MOST * steps:
            raise ValueRangeError(
                f"{self._what}: it would swing with {turned / period_s / 2 / math.pi:.0f} Hz in its field, "
                f"too fast for a time step of {1000 * period_s / steps:g} ms; give the model a shorter one, "
                "or the joint more armature"
            )

    def give(self, steps: float, seconds: float, shaft: TurnedShaft) -> float:
        """Let some time pass. Return the mean torque at the joint."""
        self.angle_rad, self.speed_rad_s = shaft.angle_rad * self.ratio, shaft.speed_rad_s * self.ratio
        self.load_nm, self._inertia = shaft.load_nm / self.ratio, shaft.inertia_kg_m2 / self.ratio**2
        before = self.speed_rad_s
        self.follow(steps, seconds)
        if seconds <= 0:
            return 0.0
        gained = (self.speed_rad_s - before) / self.ratio
        return shaft.inertia_kg_m2 * gained / seconds + shaft.load_nm
