# SPDX-License-Identifier: BSD-3-Clause
"""The arm behind the board: each servo has a loop, a gear with friction, and a part of the arm."""

from __future__ import annotations

import math
from dataclasses import dataclass

from unitylink.simulate import Registers
from unitylink.spec import Spec

PERIOD_S = 0.002
COUNTS_A_RAD, MIDDLE = 4096 / (2 * math.pi), 2048
UPPER_ARM_M, FOREARM_M, HAND_M = 0.12, 0.12, 0.09
FOREARM_KG, HAND_KG, GRAVITY = 0.15, 0.12, 9.81
STALL_NM, FREE_RAD_S = 2.9, 4.7  # of a servo at 12 V
STIFFNESS_NM, DAMPING_NM_S = 60.0, 1.4  # of its loop: N m for each rad of error, and for each rad/s
FRICTION_NM = 0.15  # of its gear, also without torque
INERTIAS = (0.02, 0.03, 0.02, 0.012, 0.01, 0.008, 0.006)  # kg m^2, with that of the gear


@dataclass
class Joint:
    """A joint in rad and rad/s. `load` is the share of the torque that its servo gives, -1 to 1."""

    inertia: float
    at: float = 0.0
    speed: float = 0.0
    load: float = 0.0

    def step(self, goal: float | None, weight_nm: float, seconds: float) -> None:
        """Move on. Without a goal there is no torque. `weight_nm` is what gravity does to it."""
        given = 0.0
        if goal is not None:
            most = STALL_NM * max(0.0, 1 - abs(self.speed) / FREE_RAD_S)
            given = STIFFNESS_NM * (goal - self.at) - DAMPING_NM_S * self.speed
            braking = given * self.speed < 0
            given = min(max(given, -STALL_NM if braking else -most), STALL_NM if braking else most)
        self.load = given / STALL_NM
        torque = given + weight_nm
        if self.speed == 0.0 and abs(torque) <= FRICTION_NM:
            return  # it sticks
        torque -= math.copysign(FRICTION_NM, self.speed or torque)
        before, self.speed = self.speed, self.speed + torque / self.inertia * seconds
        if before * self.speed < 0:
            self.speed = 0.0  # friction stops it, and does not turn it round
        self.at += self.speed * seconds


class Plant:
    period_s = PERIOD_S

    def __init__(self) -> None:
        self.joints = [Joint(inertia) for inertia in INERTIAS]

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        bus = registers.components["arm"]
        self.servos = [bus.servo(number) for number in range(len(self.joints))]
        self.tell()

    def angles(self) -> list[float]:
        """Return where the joints truly are, in rad."""
        return [joint.at for joint in self.joints]

    def step(self, time_s: float) -> None:
        """Move all joints on, and let the servos tell it. All angles are 0 where the arm stands upright."""
        _, shoulder, elbow, _, wrist, _, _ = self.angles()
        forearm_nm = GRAVITY * math.sin(shoulder + elbow) * (FOREARM_KG + HAND_KG) * FOREARM_M
        hand_nm = GRAVITY * math.sin(shoulder + elbow + wrist) * HAND_KG * HAND_M
        upper_nm = GRAVITY * math.sin(shoulder) * (FOREARM_KG + HAND_KG) * UPPER_ARM_M
        weights_nm = (0.0, upper_nm + forearm_nm + hand_nm, forearm_nm + hand_nm, 0.0, hand_nm, 0.0, 0.0)
        for joint, servo, weight_nm in zip(self.joints, self.servos, weights_nm, strict=True):
            goal = (servo.goal - MIDDLE) / COUNTS_A_RAD if servo.torque else None
            joint.step(goal, weight_nm, PERIOD_S)
        self.tell()

    def tell(self) -> None:
        """Let the servos measure: whole counts, counts a second, and parts of 1/1000 of the torque."""
        for joint, servo in zip(self.joints, self.servos, strict=True):
            position = MIDDLE + COUNTS_A_RAD * joint.at
            servo.tell(position, COUNTS_A_RAD * joint.speed, 1000 * joint.load)
