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
        joint, position, speed = self.joint, self.position, self.speed
        most = _FORCE_MARGIN * joint.acceleration_limit
        force = _SERVO_RAD_S**2 * (self._profile_position - position) + 2 * _SERVO_RAD_S * (
            self._profile_speed - speed
        )
        speed += _within(-most, force, most) / inertia * dt_s
        position += speed * dt_s
        if not joint.low <= position <= joint.high:  # it is against a mechanical stop
            position, speed = _within(joint.low, position, joint.high), 0.0
        self.position, self.speed = position, speed

    def _step_profile(self, set_point: float, speed_limit: float, dt_s: float) -> None:
        joint, speed = self.joint, self._profile_speed
        target = _within(joint.low, set_point, joint.high)
        error = target - self._profile_position
        fastest = speed_limit if speed_limit < joint.speed_limit else joint.speed_limit
        step_up = joint.acceleration_limit * dt_s
        # The highest speed from which the joint can still stop at the target, in whole steps.
        braking = math.sqrt(step_up * step_up / 4 + 2 * joint.acceleration_limit * abs(error)) - step_up / 2
        wanted = math.copysign(fastest if fastest < braking else braking, error)
        if fastest > 0 and abs(error) <= abs(wanted) * dt_s + 1e-9 and abs(speed) <= 2 * step_up:
            self._profile_position, self._profile_speed = target, 0.0
            return
        speed += _within(-step_up, wanted - speed, step_up)
        self._profile_speed = speed
        self._profile_position += speed * dt_s


def _within(low: float, number: float, high: float) -> float:
    """Return the number, or the limit that it is beyond. It is quicker than min and max."""
    if number < low:
        return low
    return high if number > high else number
