# SPDX-License-Identifier: BSD-3-Clause
"""An arm of two joints, for tests: its spec and a plant."""

from __future__ import annotations

from pathlib import Path

SPEC = """
public small_arm() {
   j[2]: joint() @ (0x10+i*8, 0x11+i*8, 0x12+i*8);
   @speed_limit = 0x30: u16 WRITE(UNIT="rad/s", SCALE=0.001, MAX=10, SAFE=0);
   @grip = 0x31: i16 WRITE(UNIT="N", SCALE=0.01, MIN=-5, MAX=5, OVERFLOW=saturate, SAFE=0);
   @fault = 0x32: bool READ(PUBLISH(100 Hz));
   @mode = 0x33: Mode READ();
}
enum Mode : u2 { idle = 0; run = 1; }
joint(): @ (p, v, s) {
   @position = p: i16 READ(UNIT="rad", SCALE=0.001, PUBLISH(100 Hz));
   @speed = v: i16 READ(UNIT="rad/s", SCALE=0.001, PUBLISH(100 Hz));
   @target = s: i16 WRITE(UNIT="rad", SCALE=0.001, MIN=-2, MAX=2, SAFE=0);
}
"""
PLANT = """
class Plant:
    period_s = 0.001
    def attach(self, spec, registers):
        self.registers = registers
        self.place = [0, 0]
    def step(self, time_s):
        for j in range(2):
            target = (self.registers[0x12 + 8 * j] & 0xFFFF ^ 0x8000) - 0x8000
            gone = target - self.place[j]
            self.place[j] += (gone > 0) - (gone < 0)
            self.registers[0x10 + 8 * j] = self.place[j]
            self.registers[0x11 + 8 * j] = 1000 * ((gone > 0) - (gone < 0))
"""


def write_arm(folder: Path) -> str:
    """Write spec and plant, and return the URL of the virtual board."""
    (folder / "small_arm.ul").write_text(SPEC)
    (folder / "plant.py").write_text(PLANT)
    return f"sim:{folder / 'small_arm.ul'}?plant={folder / 'plant.py'}"
