# SPDX-License-Identifier: BSD-3-Clause
"""The stage behind the board: each axis is a carriage on a stepper motor, with friction and switches."""

from __future__ import annotations

import math
from dataclasses import dataclass

from unitylink.simulate import Registers
from unitylink.spec import Spec

STEPS_A_MM = 80.0
LENGTH_MM = 200.0  # between the end stops
LIMIT_MM = 2.0  # a limit switch closes so far before its end stop
HOME_MM = 10.0  # below this, the home switch is closed
LOST_MM = 0.16  # a motor that lags by two full steps slips to the next four
PERIOD_S = 0.0005


@dataclass
class Axis:
    """A carriage of `mass_kg`. The magnetic field pulls it to the place that the steps say."""

    at_mm: float  # where it stands when the power comes
    mass_kg: float
    stiffness: float = 400_000.0  # N/m
    damping: float = 60.0  # N s/m
    friction_n: float = 2.0
    speed: float = 0.0  # mm/s
    start_mm: float = 0.0  # the place of step 0
    lost: int = 0  # slips

    def __post_init__(self) -> None:
        self.start_mm = self.at_mm

    def step(self, steps: float, seconds: float) -> None:
        """Move on with the field at `steps`. Short steps of time keep the spring stable."""
        parts = 10
        for _ in range(parts):
            lag_mm = self.start_mm + steps / STEPS_A_MM - self.at_mm
            if abs(lag_mm) > LOST_MM:
                slip = math.copysign(2 * LOST_MM, lag_mm)
                self.start_mm -= slip
                lag_mm -= slip
                self.lost += 1
            force_n = (self.stiffness * lag_mm - self.damping * self.speed) / 1000
            if self.speed:
                force_n -= math.copysign(self.friction_n, self.speed)
            elif abs(force_n) <= self.friction_n:
                continue  # it sticks
            before = self.speed
            self.speed += 1000 * force_n / self.mass_kg * seconds / parts
            if before * self.speed < 0:
                self.speed = 0.0  # friction stops it, and does not turn it round
            self.at_mm += self.speed * seconds / parts
            if not 0.0 <= self.at_mm <= LENGTH_MM:
                self.at_mm = min(max(self.at_mm, 0.0), LENGTH_MM)
                self.speed = 0.0


class Plant:
    period_s = PERIOD_S

    def __init__(self) -> None:
        self.axes = [Axis(37.3, 1.5), Axis(4.2, 1.0), Axis(22.9, 0.6)]

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self.motor = registers.components["motor"]
        self.steps = [self.motor.steps("step", "direction", number) for number in range(3)]
        self.switches()

    def step(self, time_s: float) -> None:
        """Move all axes on by a period. The steps of the period come evenly."""
        for number, axis in enumerate(self.axes):
            before, after = self.steps[number], self.motor.steps("step", "direction", number)
            self.steps[number] = after
            axis.step((before + after) / 2, self.period_s)
        self.switches()

    def switches(self) -> None:
        for number, axis in enumerate(self.axes):
            self.motor.drive("limit_low", axis.at_mm < LIMIT_MM, number)
            self.motor.drive("limit_high", axis.at_mm > LENGTH_MM - LIMIT_MM, number)
            self.motor.drive("home", axis.at_mm < HOME_MM, number)
