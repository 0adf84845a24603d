# SPDX-License-Identifier: BSD-3-Clause
"""What is between a channel of `dshot` and a joint of a model: a speed controller and its motor."""

from __future__ import annotations

from typing import Any

from ...components import BoardComponent
from ...machine import Supply, TurnedMotor
from .drives import Axis
from .model_joint import Push


class SpeedDrive:
    """A speed controller that commutates a brushless motor in blocks. At throttle 0 its gates are off."""

    def __init__(
        self,
        component: BoardComponent,
        supply: Supply,
        motor: TurnedMotor,
        axis: Axis,
        push: Push,
        *,
        pole_pairs: int,
        channel: int,
    ) -> None:
        self._controller = component.controller(channel)
        self._supply, self.motor, self._pole_pairs = supply, motor, pole_pairs
        self._axis, self._push = axis, push

    @property
    def currents_a(self) -> tuple[float, ...]:
        return (self.motor.current_a,)

    def push(self, seconds: float) -> None:
        throttle, volts = self._controller.throttle, self._supply.volts
        self.motor.speed_rad_s = self._axis.speed
        self.motor.step(throttle * volts if throttle > 0 else None, seconds, supply_v=volts)
        self._push.give(self._axis.sign * self.motor.taken_torque_nm())
        self._controller.turn(self._axis.speed * self.motor.gear.ratio * self._pole_pairs)


class ThrottleDrive:
    """A speed controller without a motor: its throttle is the share of the most that an actuator does."""

    def __init__(
        self, component: BoardComponent, data: Any, actuator: int, most: float, *, channel: int
    ) -> None:
        self._controller = component.controller(channel)
        self._data, self._actuator, self._most = data, actuator, most

    def push(self, seconds: float) -> None:
        self._data.ctrl[self._actuator] = self._most * self._controller.throttle
