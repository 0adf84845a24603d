# SPDX-License-Identifier: BSD-3-Clause
"""The four joints: each motor turns its joint as its bridge lets it, and an encoder shows the angle."""

from __future__ import annotations

import math

from unitylink.simulate import Registers
from unitylink.spec import Spec

JOINTS = ("j1", "j2", "j3", "j4")
SPEED = 5.0  # rad/s of a joint at full duty
TIME_CONSTANT_S = 0.02
COUNTS = 65536  # of an encoder, for a turn of the joint


class Joint:
    """A DC motor with a gear, which stands still soon after its bridge is off."""

    def __init__(self, name: str, registers: Registers) -> None:
        self.motor, self.shaft = registers.components[f"{name}.motor"], registers.components[f"{name}.shaft"]
        self.angle = self.speed = 0.0  # rad, rad/s

    def step(self, seconds: float) -> None:
        """Turn with the mean voltage of the bridge."""
        duty = self.motor.duty("pins", 0) - self.motor.duty("pins", 2)  # high gate A forward, B back
        self.speed += (SPEED * duty - self.speed) * (1 - math.exp(-seconds / TIME_CONSTANT_S))
        self.angle += self.speed * seconds
        self.shaft.turn(self.angle * COUNTS / (2 * math.pi), seconds)


class Plant:
    """Joints that start at 0 rad."""

    period_s = 1e-3

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Find the parts by their names."""
        self.joints = [Joint(name, registers) for name in JOINTS]

    def step(self, time_s: float) -> None:
        for joint in self.joints:
            joint.step(self.period_s)
