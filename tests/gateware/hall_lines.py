# SPDX-License-Identifier: BSD-3-Clause
"""The lines of three Hall sensors, for the comparison of hall with its VHDL."""

from __future__ import annotations

import random
from collections.abc import Iterator

from gateware.clock_true import RESET_CLOCKS, Stimulus

_CODES = (0b101, 0b001, 0b011, 0b010, 0b110, 0b100)  # of the sectors, line 2 first
_LONG = 140_000  # clocks, so that the time of a sector is full


def hall_lines(draw: random.Random, end: int) -> Iterator[Stimulus]:
    """Turn a rotor both ways, faster and slower, with rests.

    Some edges bounce, and some codes cannot be.
    """
    levels, sector, now = 0, draw.randrange(6), RESET_CLOCKS
    while now < end - 20:
        way, apart = draw.choice((1, 1, -1)), draw.choice((3, 20, 130, 400, 900))
        for _ in range(draw.randrange(1, 14)):
            sector = (sector + way) % 6
            codes = [draw.randrange(8)] if draw.random() < 0.05 else []
            if draw.random() < 0.2:
                codes += [_CODES[sector], levels]
            for code in (*codes, _CODES[sector]):
                for pin in range(3):
                    if (code ^ levels) >> pin & 1:
                        yield now, "p", pin, code >> pin & 1
                levels = code
                now += draw.randrange(1, 12)
            now += max(1, round(apart * draw.uniform(0.6, 1.5)))
        if draw.random() < 0.1:
            now += draw.choice((2000, _LONG))
