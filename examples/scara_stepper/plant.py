# SPDX-License-Identifier: BSD-3-Clause
"""The arm behind the board: each joint is a mass on a belt that its motor pulls, with friction."""

from __future__ import annotations

import math
from dataclasses import dataclass

from unitylink.simulate import Registers
from unitylink.spec import Spec

PERIOD_S = 0.001
UPPER_ARM_M, FOREARM_M, HAND_KG = 0.25, 0.20, 0.6
SHOULDER_INERTIA, ELBOW_INERTIA, TOOL_INERTIA, LIFT_KG = 0.03, 0.012, 0.002, 1.2
RAD_A_STEP, M_A_STEP = 2 * math.pi / 16000, 0.001 / 400


@dataclass
class Joint:
    """A joint in rad and N m, or in m and N. `at` follows `pulled` like a mass on a spring."""

    stiffness: float
    friction: float
    low: float
    high: float
    at: float = 0.0
    speed: float = 0.0

    def step(self, pulled: float, inertia: float, seconds: float) -> None:
        """Move on with the belt at `pulled`. The belt damps a fifth of what would stop it from ringing."""
        parts = 8
        damping = 0.4 * math.sqrt(self.stiffness * inertia)
        for _ in range(parts):
            force = self.stiffness * (pulled - self.at) - damping * self.speed
            if self.speed == 0.0 and abs(force) <= self.friction:
                continue  # it sticks
            force -= math.copysign(self.friction, self.speed or force)
            before, self.speed = self.speed, self.speed + force / inertia * seconds / parts
            if before * self.speed < 0:
                self.speed = 0.0  # friction stops it, and does not turn it round
            self.at += self.speed * seconds / parts
            if not self.low <= self.at <= self.high:
                self.at, self.speed = min(max(self.at, self.low), self.high), 0.0


class Plant:
    period_s = PERIOD_S

    def __init__(self) -> None:
        self.shoulder = Joint(900.0, 0.15, -2.3, 2.3)
        self.elbow = Joint(350.0, 0.08, -2.6, 2.6)
        self.tool = Joint(60.0, 0.01, -6.3, 6.3)
        self.lift = Joint(300_000.0, 3.0, -0.001, 0.08)

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self.parts = registers.components["arm"], registers.components["lift"]
        self.step(0.0)

    def joints_deg_mm(self) -> tuple[float, float, float, float]:
        """Return shoulder, elbow and tool in deg, and the lift in mm, as they truly are."""
        turned = (math.degrees(joint.at) for joint in (self.shoulder, self.elbow, self.tool))
        shoulder, elbow, tool = turned
        return shoulder, elbow, tool, 1000 * self.lift.at

    def step(self, time_s: float) -> None:
        """Move all joints on. The shoulder carries more where the arm is stretched."""
        arm, lift = self.parts
        shoulder, elbow, tool = (RAD_A_STEP * arm.steps("step", "direction", axis) for axis in range(3))
        reach2 = UPPER_ARM_M**2 + FOREARM_M**2 + 2 * UPPER_ARM_M * FOREARM_M * math.cos(self.elbow.at)
        self.shoulder.step(shoulder, SHOULDER_INERTIA + HAND_KG * reach2, PERIOD_S)
        self.elbow.step(elbow, ELBOW_INERTIA + HAND_KG * FOREARM_M**2, PERIOD_S)
        self.tool.step(tool, TOOL_INERTIA, PERIOD_S)
        self.lift.step(M_A_STEP * lift.steps("step", "direction"), LIFT_KG, PERIOD_S)
