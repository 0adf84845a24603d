# SPDX-License-Identifier: BSD-3-Clause
"""What is between a servo of a bus and a joint of a model."""

from __future__ import annotations

import math
from typing import NamedTuple

from ...components import BoardComponent
from .drives import Axis

_WORD_MOST = 0x7FFF
_LOAD_MOST = 1023  # of Feetech; a share of more than all is none


class ServoCounts(NamedTuple):
    """What a count of a servo is at the joint, in SI. An infinite load is one that nobody knows."""

    position: float
    at_zero: float  # the position at the count 0
    speed: float
    load: float


class BusServoDrive:
    """A servo of a `servo_bus` with a position actuator. Without torque, the joint turns freely."""

    def __init__(
        self, component: BoardComponent, axis: Axis, actuator: int, *, channel: int, counts: ServoCounts
    ) -> None:
        self._servo = component.servo(channel)
        self._axis, self._actuator, self._counts = axis, actuator, counts
        self.show()
        self.push(0.0)

    def push(self, seconds: float) -> None:
        axis, counts = self._axis, self._counts
        goal = axis.sign * (self._servo.goal * counts.position + counts.at_zero)
        here = float(axis.data.qpos[axis.joint.position])
        axis.data.ctrl[self._actuator] = goal if self._servo.torque else here

    def show(self, seconds: float = 0.0) -> None:
        """Let the servo measure how the joint is."""
        axis, counts = self._axis, self._counts
        force = axis.sign * float(axis.data.actuator_force[self._actuator])
        self._servo.tell(
            _within((axis.angle - counts.at_zero) / counts.position, _WORD_MOST),
            _within(axis.speed / counts.speed, _WORD_MOST),
            0 if math.isinf(counts.load) else _within(force / counts.load, _LOAD_MOST),
        )


def _within(number: float, most: int) -> float:
    return min(max(number, -most), most)
