# SPDX-License-Identifier: BSD-3-Clause
"""The joint behind the board: an inertia with friction, which the torque turns."""

from __future__ import annotations

from unitylink.simulate import BoardValues, Registers
from unitylink.spec import Spec

INERTIA = 0.02  # kg m^2
FRICTION = 0.05  # N m for each rad/s


class Plant:
    period_s = 0.001

    def __init__(self) -> None:
        self.angle = self.speed = 0.0

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self.values = BoardValues(spec, registers)
        self.step(0.0)

    def step(self, time_s: float) -> None:
        """Turn for a period."""
        self.speed += (self.values["torque"] - FRICTION * self.speed) / INERTIA * self.period_s
        self.angle += self.speed * self.period_s
        self.values["angle"], self.values["speed"] = self.angle, self.speed
