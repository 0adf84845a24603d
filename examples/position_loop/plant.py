# SPDX-License-Identifier: BSD-3-Clause
"""The motor and its shaft: the speed follows the duty, and an encoder shows the angle."""

from __future__ import annotations

import math

from unitylink.simulate import Registers
from unitylink.spec import Spec

SPEED = 60.0  # rad/s at full duty
TIME_CONSTANT_S = 0.05
COUNTS = 4096  # of the encoder, for a turn


class Plant:
    period_s = 0.0002

    def __init__(self) -> None:
        self.angle = self.speed = 0.0  # rad, rad/s

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Find the parts by their names."""
        self.motor, self.shaft = registers.components["motor"], registers.components["shaft"]

    def step(self, time_s: float) -> None:
        """Let the motor run for a period with the mean voltage of its bridge."""
        duty = self.motor.duty("pins", 0) - self.motor.duty("pins", 2)  # high gate A forward, B back
        share = 1 - math.exp(-self.period_s / TIME_CONSTANT_S)
        self.speed += (SPEED * duty - self.speed) * share
        self.angle += self.speed * self.period_s
        self.shaft.turn(self.angle * COUNTS / (2 * math.pi), self.period_s)
