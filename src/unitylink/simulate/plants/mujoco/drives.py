# SPDX-License-Identifier: BSD-3-Clause
"""What is between the output pins of a component and a joint of a model: motors, servos and steppers."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from typing import Any, Generic, NamedTuple, Protocol, TypeVar

from ...components import BoardComponent
from ...machine import Bridge, Inverter, RcServoData, TurnedBrushless, TurnedMotor
from .model_joint import ModelJoint, Push

_SILENT_S = 0.05  # a servo without a pulse for so long is off


class Axis(NamedTuple):
    """A joint of a model in motion. With a `sign` of -1, the drive goes the other way."""

    joint: ModelJoint
    data: Any
    sign: int = 1

    @property
    def angle(self) -> float:
        return self.sign * float(self.data.qpos[self.joint.position])

    @property
    def speed(self) -> float:
        return self.sign * float(self.data.qvel[self.joint.dof])


class Drive(Protocol):
    """Looks at pins, and pushes a joint."""

    def push(self, seconds: float) -> None:
        """Let it push in the next step of the plant as the pins were in the last one, of so many seconds."""


Motor = TypeVar("Motor", TurnedMotor, TurnedBrushless)


class WindingsDrive(ABC, Generic[Motor]):
    """A motor whose currents also flow between two steps of the plant, where something looks at its pins."""

    def __init__(self, motor: Motor, axis: Axis, push: Push) -> None:
        self.motor: Motor = motor
        self._axis, self._push = axis, push
        self._looked = False

    def look(self, seconds: float) -> None:
        """Let the currents flow as the pins were in a part of a step of the plant."""
        self._flow(seconds)
        self._looked = True

    def push(self, seconds: float) -> None:
        if not self._looked:
            self.look(seconds)
        self._looked = False
        self._push.give(self._axis.sign * self.motor.taken_torque_nm())

    @abstractmethod
    def _flow(self, seconds: float) -> None:
        """Let the currents flow for so long, as the pins are."""


class MotorDrive(WindingsDrive[TurnedMotor]):
    """A DC motor on a bridge."""

    def __init__(self, bridge: Bridge, motor: TurnedMotor, axis: Axis, push: Push) -> None:
        super().__init__(motor, axis, push)
        self._bridge = bridge

    @property
    def currents_a(self) -> tuple[float, ...]:
        return (self.motor.current_a,)

    def _flow(self, seconds: float) -> None:
        self.motor.speed_rad_s = self._axis.speed
        self._bridge.drive(self.motor, seconds)


class BrushlessDrive(WindingsDrive[TurnedBrushless]):
    """A brushless motor on an inverter. It turns between two steps of the plant, too."""

    def __init__(self, inverter: Inverter, motor: TurnedBrushless, axis: Axis, push: Push) -> None:
        super().__init__(motor, axis, push)
        self._inverter = inverter

    @property
    def currents_a(self) -> tuple[float, ...]:
        return self.motor.currents_a

    def _flow(self, seconds: float) -> None:
        if not self._looked:
            self.motor.turn(self._axis.angle, self._axis.speed)
        self._inverter.drive(self.motor, seconds)


class ShareDrive:
    """A bridge without a motor: its share of the time, -1 to 1, is that of the most that an actuator does."""

    def __init__(self, bridge: Bridge, data: Any, actuator: int, most: float) -> None:
        self._bridge, self._data, self._actuator, self._most = bridge, data, actuator, most

    def push(self, seconds: float) -> None:
        self._data.ctrl[self._actuator] = self._most * self._bridge.seen()[0]


class ServoDrive:
    """A servo of model making, with a position actuator. Without pulses it holds where it is."""

    def __init__(
        self,
        component: BoardComponent,
        servo: RcServoData,
        axis: Axis,
        actuator: int,
        *,
        channel: int,
        zero_rad: float,
    ) -> None:
        self._pins, self._channel, self._servo = component, channel, servo
        self._axis, self._actuator, self._zero_rad = axis, actuator, zero_rad
        self._silent_s = _SILENT_S
        component.level("pins", channel)  # is there such a pin?
        self._hold()

    def push(self, seconds: float) -> None:
        pulse_s = self._pins.pulse_s("pins", self._channel)
        if pulse_s is not None:
            self._silent_s = 0.0
            servo = self._servo
            turned = (1e6 * pulse_s - servo.centre_us) / servo.us_per_deg
            goal = math.radians(min(max(turned, -servo.reach_deg), servo.reach_deg))
            self._axis.data.ctrl[self._actuator] = self._axis.sign * (goal - self._zero_rad)
        elif self._silent_s < _SILENT_S:
            self._silent_s += seconds
            if self._silent_s >= _SILENT_S:
                self._hold()

    def _hold(self) -> None:
        data = self._axis.data
        data.ctrl[self._actuator] = data.qpos[self._axis.joint.position]


class StepDrive:
    """A stepper with a position actuator. It begins where the joint is, and loses no step."""

    def __init__(
        self, component: BoardComponent, axis: Axis, actuator: int, *, channel: int, step: float
    ) -> None:
        self._pins, self._axis, self._actuator = component, axis, actuator
        self._channel, self._step = channel, step
        self._start = axis.angle
        self.push(0.0)

    def push(self, seconds: float) -> None:
        steps = self._pins.steps("step", "direction", self._channel)
        self._axis.data.ctrl[self._actuator] = self._axis.sign * (self._start + steps * self._step)
