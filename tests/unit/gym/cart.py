# SPDX-License-Identifier: BSD-3-Clause
"""A cart that is pushed, for tests: its spec, its plant and a reward."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

SPEC = """
public cart() {
   @position = 0x10: i32 READ(UNIT="m", SCALE=0.0001, PUBLISH(100 Hz));
   @at_end = 0x11: bool READ();
   @force = 0x20: i16 WRITE(UNIT="N", SCALE=0.01, MIN=-5, MAX=5, SAFE=0);
   @trim = 0x21: i16 WRITE(UNIT="N", SCALE=0.01, MIN=-1, MAX=1, OVERFLOW=saturate);
}
"""
PLANT = """
import random
class Plant:
    period_s = 0.001
    def __init__(self):
        self.place, self.speed = 0.0, 0.0
    def seed(self, number):
        self.place = random.Random(number).uniform(-0.1, 0.1)
    def attach(self, spec, registers):
        self.registers = registers
    def step(self, time_s):
        force = (self.registers.signed(0x20) + self.registers.signed(0x21)) / 100
        self.speed += force * self.period_s
        self.place += self.speed * self.period_s
        self.registers[0x10] = round(self.place * 10_000)
        self.registers[0x11] = int(abs(self.place) > 1)
"""


def near_the_middle(seen: Mapping[str, Any], written: Mapping[str, Any]) -> float:
    return -abs(float(seen["position"])) - 0.01 * abs(float(written["force"]))


def cart_url(folder: Path) -> str:
    """Write spec and plant into a folder. Return the URL of the virtual board."""
    (folder / "cart.ul").write_text(SPEC)
    (folder / "cart.py").write_text(PLANT)
    return f"sim:{folder / 'cart.ul'}?plant={folder / 'cart.py'}"
