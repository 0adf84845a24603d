# SPDX-License-Identifier: BSD-3-Clause
"""What the far end of `uart_bridge` puts on its line: characters at many rates, some of them broken."""

from __future__ import annotations

import random
from collections.abc import Iterator

from gateware.clock_true import RESET_CLOCKS, Stimulus
from gateware.servo_line import changes

# Clocks of a bit at the rates of the cases, where the clock is 400 kHz.
_BITS = (8.0, 8.0, 10.42, 10.6, 20.83, 41.67)


def serial_line(draw: random.Random, end: int) -> Iterator[Stimulus]:
    """Yield the changes of a line that rests high."""
    now = float(RESET_CLOCKS)
    yield int(now), "p", 0, 1
    while now < end:
        bit = draw.choice(_BITS)
        for _ in range(draw.choice((1, 2, 7))):
            byte = [draw.randrange(2) for _ in range(8)]
            check = draw.choice(([], [sum(byte) % 2], [1 - sum(byte) % 2]))
            frame = [0, *byte, *check, int(draw.random() < 0.9), 1]
            yield from changes(now + 1, bit, frame)
            now += (len(frame) + 1) * bit + draw.choice((0, 1, 30))
        now += draw.randrange(1, 1500)
