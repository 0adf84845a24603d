# SPDX-License-Identifier: BSD-3-Clause
"""What is between a model and the input pins of a component: encoders, switches and sensors."""

from __future__ import annotations

import math
from typing import Any, Protocol

from ...components import BoardComponent
from ...machine import EndSwitch, HallSensors
from .drives import BrushlessDrive, MotorDrive
from .model_joint import ModelJoint

_SECTOR_RAD = math.pi / 3  # of an electrical turn


class Shown(Protocol):
    """Looks at the model, and drives pins."""

    def show(self, seconds: float) -> None:
        """Show how the model is after a step of the plant of so many seconds."""


class ShownEncoder:
    """Lines that count. They begin at 0 where the joint is, as a counter does when the power comes."""

    def __init__(
        self,
        component: BoardComponent,
        data: Any,
        position: int,
        a_count: float,
        *,
        per_turn: int = 0,
        channel: int = 0,
    ) -> None:
        self._pins, self._data, self._position = component, data, position
        self._a_count, self._per_turn, self._channel = a_count, per_turn, channel
        self._start = float(data.qpos[position])

    def show(self, seconds: float) -> None:
        counts = (float(self._data.qpos[self._position]) - self._start) / self._a_count
        self._pins.turn(counts, seconds, per_turn=self._per_turn, channel=self._channel)


class ShownAbsolute:
    """An encoder that knows where the joint is. `zero` is what it reads where the joint is at 0."""

    def __init__(
        self, component: BoardComponent, data: Any, joint: ModelJoint, a_count: float, zero: float
    ) -> None:
        self._encoder = component.serial_encoder()
        self._data, self._joint, self._a_count, self._zero = data, joint, a_count, zero
        self._time_s = self._since_s = -1.0

    def show(self, seconds: float) -> None:
        data, joint = self._data, self._joint
        # between two steps of the model it goes on with its speed
        self._since_s = self._since_s + seconds if self._time_s == data.time else 0.0
        self._time_s = data.time
        at = float(data.qpos[joint.position]) + float(data.qvel[joint.dof]) * self._since_s
        self._encoder.turn(at / self._a_count + self._zero)


class ShownHall:
    """The three lines of a brushless motor. `a_sector` is what the joint does from one sector to the next."""

    def __init__(
        self, component: BoardComponent, data: Any, position: int, a_sector: float, zero: float
    ) -> None:
        self._sensors = HallSensors(component, pole_pairs=1)
        self._data, self._position, self._zero = data, position, zero
        self._electrical = _SECTOR_RAD / a_sector

    def show(self, seconds: float) -> None:
        at = float(self._data.qpos[self._position]) + self._zero
        self._sensors.show(at * self._electrical, seconds)


class ShownSwitch:
    """A switch at a place of the joint. `factor` is from the joint to the unit of the place."""

    def __init__(self, switch: EndSwitch, data: Any, position: int, factor: float, zero: float) -> None:
        self._switch, self._data, self._position = switch, data, position
        self._factor, self._zero = factor, zero

    def show(self, seconds: float) -> None:
        self._switch.show(float(self._data.qpos[self._position]) * self._factor + self._zero)


class ShownDistance:
    """What a rangefinder sees, at the lines of a sonar."""

    def __init__(self, component: BoardComponent, data: Any, sensor: int) -> None:
        self._sensor, self._data, self._at = component.distance_sensor(), data, sensor

    def show(self, seconds: float) -> None:
        metres = float(self._data.sensordata[self._at])
        self._sensor.see(metres if 0 < metres <= 30 else None)  # MuJoCo has -1 for nothing in sight


class ShownForce:
    """What a force sensor measures, at the lines of an hx711. `a_count` is the force of a count."""

    def __init__(
        self, component: BoardComponent, data: Any, sensor: int, a_count: float, zero: float
    ) -> None:
        self._cell, self._data, self._at = component.load_cell(), data, sensor
        self._a_count, self._zero = a_count, zero

    def show(self, seconds: float) -> None:
        force = float(self._data.sensordata[self._at]) + self._zero
        self._cell.weigh(round(force / self._a_count))


class ShownCurrents:
    """The currents of a motor, at the modulators of a sigma_delta_adc."""

    def __init__(
        self,
        component: BoardComponent,
        drive: MotorDrive | BrushlessDrive,
        channels: int,
        full_scale_a: float,
    ) -> None:
        self._pins, self._drive = component, drive
        self._channels, self._full_scale_a = channels, full_scale_a

    def show(self, seconds: float) -> None:
        for channel, amps in enumerate(self._drive.currents_a[: self._channels]):
            level = min(1.0, max(-1.0, amps / self._full_scale_a))
            self._pins.modulate(level, seconds, channel)
