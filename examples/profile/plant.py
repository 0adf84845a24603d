# SPDX-License-Identifier: BSD-3-Clause
"""Do what profile_player.vhd does, behind the virtual board."""

from __future__ import annotations

from unitylink.simulate import Registers
from unitylink.spec import Spec

POINTS = 32


class Plant:
    period_s = 0.001

    def __init__(self) -> None:
        self.position = 0
        self.index = POINTS  # number of the next point; beyond the last one, nothing plays

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        """Find the words by their names."""
        assert spec is not None
        self.registers = registers
        self.address = {path: element.address for path, element in spec.walk()}

    def step(self, time_s: float) -> None:
        """Go a quarter of the way to the next point, and put the new position into the queue."""
        words, at = self.registers, self.address
        if self.index < POINTS:
            word = words[at[f"table.point[{self.index}]"]]
            goal = ((word & 0xFFFF) ^ 0x8000) - 0x8000  # an i16 is in the low half of its word
            self.position += (goal - self.position) >> 2
            words[at["samples.position"]] = self.position
            self.index += 1
        elif words[at["play"]]:
            words[at["play"]] = 0  # a strobe
            self.index = 0
        words[at["playing"]] = int(self.index < POINTS)
