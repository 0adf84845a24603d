# SPDX-License-Identifier: BSD-3-Clause
"""What `test_clock_true` writes to components: words that make them do something."""

from __future__ import annotations

H_BRIDGE = {
    0: (0, 1, 1, 3, 3),
    2: (0, 500, 2000, 4095),
    3: (0, 0x1F, 0x20, 0x21, 5, 0xFF, 0x100, 0x80, 0x1C0, 0x101, 0x1FF),
}
THREE_PHASE = {0: (0, 1, 1, 7, 7, 3, 5), 2: (0, 500, 2000, 4095)} | dict.fromkeys(
    (3, 4, 5), (0, 0x1F, 0x20, 0x21, 5, 0xFF, 0x100, 0x80, 0x1C0)
)
# Checks that a register is 0 in the set-up and in each sample, 100 us long, so that pins at random do both.
CHECKED = "C064C00020005800D800C064C8002000580020001C01D005"
# Reads a byte from the register 0 of the device 48, as soon as the last byte is there.
SHORT = "C00AC000D800C014C8002090000020911C01D003"
# Clocks between the edges of an encoder: short, about a window of 246 or 292 clocks, and about a stall.
SHAFT = (1, 2, 3, 9, 27, 81, 200, 246, 247, 292, 293, 506, 507, 508, 598, 599, 600, 1500)
# Words of an axis of stepgen. Ways are short and long, ramps gentle and brutal.
STEPGEN_AXIS = {
    0: (0, 1, 1, 1, 1, 3, 3, 5, 5, 7, 9, 0x11, 0x19, 0x1D),
    1: (0, 1, 5, 40, 0xFFFFFFE0, 300, 0x80000000),
    2: (1 << 24, 1 << 27, 0xFFFFFFF, 1 << 20, 0),
    3: (1 << 14, 1 << 17, 0xFFFFF, 100, 0, 1),
    4: (0, 1 << 24, 1 << 26, 0xFF000000, 0xF8000000, 0x80000000),
    10: (1, 100, 0xFFFFFFFF),
}


def stepgen_values(axes: int) -> dict[int, tuple[int, ...]]:
    return {16 * axis + word: values for axis in range(axes) for word, values in STEPGEN_AXIS.items()}


def stepgen_start(axes: int) -> dict[int, int]:
    words = {2: 0xFFFFFFF, 3: 0xFFFFF, 1: 9, 0: 1}
    return {16 * axis + word: value for word, value in words.items() for axis in range(axes)}


PID = {
    0: (1, 1, 1, 0),
    2: (0, 5, 1 << 20, -3 & 0xFFFFFFFF),
    3: (0, 700, -80 & 0xFFFFFFFF),
    4: (0, 9000, -70000 & 0xFFFFFFFF),
    5: (0, 1 << 8, 1 << 14, 0xFFFFFF),
    6: (0, 1 << 6, 1 << 14, 0xFFFFFF),
    7: (0, 1 << 6, 0xFFFFFF),
    8: (0, 1 << 4, 0xFFFFFF),
    9: (0, 1 << 4, 0xFFFFFF),
    10: (3, 100, 4095, 1 << 20),
    11: (0, 0, 0, 0xFFFFFF),
}
FOC_WIRES = "from.position, from.position, from.position, bridge.duty[0], bridge.duty[1], bridge.duty[2]"
FOC_START = {4: 1 << 12, 5: 1 << 14, 8: 1, 0: 1}
FOC = {
    0: (*[1] * 5, 3, 0, 0),
    2: (0, 300, -9000 & 0xFFFFFFFF, 0x8000),
    3: (0, 700, -20000 & 0xFFFFFFFF, 0x7FFF),
    4: (0, 1 << 10, 1 << 14, 0x1FFFF),
    5: (0, 1 << 10, 1 << 14, 0x1FFFF),
    6: (75_674, 75_674, 0, 9000, 0x1FFFF),
}
PROFILE = {
    0: (*[1] * 9, 0),
    2: (0, 5, 90, 300, 400, -3 & 0xFFFFFFFF, 0x80000000),
    3: (1 << 24, 1 << 26, 1 << 27, 0xFFFFFFFF, 0),
    4: (1 << 20, 1 << 22, 1 << 23, 0xFFFFFF),
}
ABSOLUTE_ENCODER = {0: (1,) * 15 + (0,), 6: (0, 0x7FFFFFFF)}
# Words of up to three servos, and the control behind them, which is seldom 0.
SERVO_BUS = {8 * n: (0, 1, 1, 2, 2, 2, 3) for n in range(2)} | {
    **{8 * n + 1: (0, 1, 2048, 0xFFFF, 0xFDFF, 0x8000) for n in range(3)},
    16: (1, *[3] * 20, 0),
    24: (*[1] * 20, 0),
}
COMPARE = {
    0: (*[1] * 5, *[3] * 5, 5, 7, 0),
    1: (0, 90, 1 << 12, -90 & 0xFFFFFFFF),
    2: (0, 0, 1 << 9, 1 << 13, 1 << 28),
}
PULSES = {0: (0, 7, 0xFFFFFFFE), 1: (*[0] * 20, 1)}
# Frequencies, widths and bursts of a generator: most of its time it runs.
GENERATOR = {
    0: (*[5_000_000] * 3, 1_000_003, 9_000_000, 128_000_000, 0),
    1: (0, 0, 1, 2, 7, 90),
    2: (0, 0, 1, 2, 5),
    3: (0, 1, 3, 7, 0xFFFFFFFF),
}
