# SPDX-License-Identifier: BSD-3-Clause
"""One joint behind a position servo. Plants of robots are made of such joints."""

from __future__ import annotations

import math
from dataclasses import dataclass

_SERVO_RAD_S = 90.0  # bandwidth of the position loop with nominal inertia, critically damped
_FORCE_MARGIN = 2.0  # position of the mass, in the unit of the joint


@dataclass(frozen=True)
class Joint:
    """Limits of one joint, in degrees or millimetres, per second and per second squared.

    `inertia` is relative to nominal.
    """

    name: str
    unit: str
    low: float
    high: float
    speed_limit: float
    acceleration_limit: float
    inertia: float = 1.0


class Axis:
    """One joint in motion: a trapezoidal profile, a servo that follows it, and a mass that cannot follow at
    once.
    """

    def __init__(self, joint: Joint) -> None:
        self.joint = joint
        self.position = 0.0  # of the mass, in the unit of the joint
        self.speed = 0.0
        self._profile_position = 0.0
        self._profile_speed = 0.0

    def step(self, set_point: float, speed_limit: float, inertia: float, dt_s: float) -> None:
        """Move on by `dt_s` towards `set_point`, no faster than `speed_limit`. `inertia` is relative to
        nominal."""
        self._step_profile(set_point, speed_limit, dt_s)
        joint = self.joint
        force_limit = _FORCE_MARGIN * joint.acceleration_limit
        force = _SERVO_RAD_S**2 * (self._profile_position - self.position) + 2 * _SERVO_RAD_S * (
            self._profile_speed - self.speed
        )
        self.speed += max(-force_limit, min(force_limit, force)) / inertia * dt_s
        self.position += self.speed * dt_s
        if not joint.low <= self.position <= joint.high:  # it is against a mechanical stop
            self.position = max(joint.low, min(joint.high, self.position))
            self.speed = 0.0

    def _step_profile(self, set_point: float, speed_limit: float, dt_s: float) -> None:
        joint = self.joint
        target = max(joint.low, min(joint.high, set_point))
        error = target - self._profile_position
        fastest = min(speed_limit, joint.speed_limit)
        step_up = joint.acceleration_limit * dt_s
        # The highest speed from which the joint can still stop at the target, in whole steps.
        braking = math.sqrt(step_up * step_up / 4 + 2 * joint.acceleration_limit * abs(error)) - step_up / 2
        wanted = math.copysign(min(fastest, braking), error)
        if (
            fastest > 0
            and abs(error) <= abs(wanted) * dt_s + 1e-9
            and abs(self._profile_speed) <= 2 * step_up
        ):
            self._profile_position, self._profile_speed = target, 0.0
            return
        self._profile_speed += max(-step_up, min(step_up, wanted - self._profile_speed))
        self._profile_position += self._profile_speed * dt_s
