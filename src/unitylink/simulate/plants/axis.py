# SPDX-License-Identifier: BSD-3-Clause
"""One joint behind a position servo. Plants of robots are made of such joints."""

from __future__ import annotations

from dataclasses import dataclass
from math import copysign, sqrt

_SERVO_RAD_S = 90.0  # bandwidth of the position loop with nominal inertia, critically damped
_STIFFNESS, _DAMPING = _SERVO_RAD_S**2, 2 * _SERVO_RAD_S
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
        self._limits = joint.low, joint.high, joint.speed_limit, joint.acceleration_limit
        self.position = 0.0  # of the mass, in the unit of the joint
        self.speed = 0.0
        self._profile_position = 0.0
        self._profile_speed = 0.0

    def step(self, set_point: float, speed_limit: float, inertia: float, dt_s: float) -> None:
        """Move on by `dt_s` towards `set_point`, no faster than `speed_limit`. `inertia` is relative to
        nominal."""
        # It is written without calls: a plant in Python is the greatest part of a step of time (lockstep.md).
        position, speed = self.position, self.speed
        low, high, speed_most, acceleration = self._limits
        profile_speed, profile = self._profile_speed, self._profile_position
        # the profile
        target = low if set_point < low else high if set_point > high else set_point
        error = target - profile
        fastest = speed_limit if speed_limit < speed_most else speed_most
        step_up = acceleration * dt_s
        # The highest speed from which the joint can still stop at the target, in whole steps.
        braking = sqrt(step_up * step_up / 4 + 2 * acceleration * abs(error)) - step_up / 2
        wanted = copysign(fastest if fastest < braking else braking, error)
        if fastest > 0 and abs(error) <= abs(wanted) * dt_s + 1e-9 and abs(profile_speed) <= 2 * step_up:
            profile, profile_speed = target, 0.0
        else:
            more = wanted - profile_speed
            profile_speed += -step_up if more < -step_up else step_up if more > step_up else more
            profile += profile_speed * dt_s
        self._profile_position, self._profile_speed = profile, profile_speed
        # the servo and the mass
        most = _FORCE_MARGIN * acceleration
        force = _STIFFNESS * (profile - position) + _DAMPING * (profile_speed - speed)
        speed += (-most if force < -most else most if force > most else force) / inertia * dt_s
        position += speed * dt_s
        if not low <= position <= high:  # it is against a mechanical stop
            position, speed = low if position < low else high, 0.0
        self.position, self.speed = position, speed
