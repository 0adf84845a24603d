# SPDX-License-Identifier: BSD-3-Clause
"""The four drives behind the ring: each turns its joint to its target, within its speed limit."""

from __future__ import annotations

from unitylink.simulate import Registers
from unitylink.spec import Spec

NODES = (2, 3, 4, 5)
POSITION, SPEED, TARGET, LIMIT = 0, 1, 4, 5  # words of a node
COUNTS_A_RAD, COUNTS_A_RAD_S = 1e5, 1e4
STIFFNESS_HZ = 8.0  # of the position loop


class Plant:
    """Joints that start at 0 rad."""

    period_s = 1e-3

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self.registers = registers
        self.at = [0.0] * len(NODES)  # rad

    def step(self, time_s: float) -> None:
        for joint, node in enumerate(NODES):
            target = signed(self.registers[64 * node + TARGET]) / COUNTS_A_RAD
            limit = signed(self.registers[64 * node + LIMIT]) / COUNTS_A_RAD_S
            speed = min(max(STIFFNESS_HZ * (target - self.at[joint]), -limit), limit)
            self.at[joint] += speed * self.period_s
            self.registers[64 * node + POSITION] = round(self.at[joint] * COUNTS_A_RAD) & 0xFFFFFFFF
            self.registers[64 * node + SPEED] = round(speed * COUNTS_A_RAD_S) & 0xFFFFFFFF


def signed(word: int) -> int:
    """Return the number that a word of 32 bits stands for."""
    return word - (word >> 31 << 32)
