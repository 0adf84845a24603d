# SPDX-License-Identifier: BSD-3-Clause
"""What a radio puts on the line of `rc_receiver`: frames of S.Bus and of PPM, some of them broken."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator

from gateware.clock_true import RESET_CLOCKS, Stimulus
from gateware.servo_line import changes

_FRAME_BYTES = 25


def sbus_line(bit: float, *, inverted: bool) -> Callable[[random.Random, int], Iterator[Stimulus]]:
    """Return a radio whose bits have so many clocks."""

    def line(draw: random.Random, end: int) -> Iterator[Stimulus]:
        now = float(RESET_CLOCKS)
        if not inverted:
            yield int(now), "p", 0, 1
        while now < end:
            flags = draw.choice((0, 0, 0, 1, 3, 4, 8, 12))
            frame = [0x0F, *(draw.randrange(256) for _ in range(22)), flags, draw.choice((0, 0, 4, 0x34))]
            if draw.random() < 0.4:
                place = draw.randrange(_FRAME_BYTES)
                frame[place : place + draw.choice((0, 1))] = draw.choice(([], [draw.randrange(256)]))
            wrong = draw.choice((draw.randrange(_FRAME_BYTES), _FRAME_BYTES - 1, -1, -1, -1, -1))
            slow = draw.choice((bit, bit, 0.98 * bit, 1.02 * bit))
            for place, byte in enumerate(frame):
                data = [byte >> number & 1 for number in range(8)]
                levels = [0, *data, sum(data) % 2 ^ (place == wrong), 1, 1]
                for at, what, pin, level in changes(now + 1, slow, levels):
                    yield at, what, pin, level ^ inverted
                now += len(levels) * slow + (draw.choice((0, 0, 1, 20)) if draw.random() < 0.1 else 0)
            now += bit * draw.choice((45, 65, 80, 300))

    return line


def ppm_line(us: float, channels: int) -> Callable[[random.Random, int], Iterator[Stimulus]]:
    """Return a radio with so many clocks in a microsecond."""

    def line(draw: random.Random, end: int) -> Iterator[Stimulus]:
        now = RESET_CLOCKS
        while now < end:
            count = draw.choice((channels, channels, channels - 1, channels + 1))
            distances = [draw.randrange(690, 2310) for _ in range(count)]
            if draw.random() < 0.2:
                distances[draw.randrange(count + 1) :] = [draw.choice((300, 500, 2690, 2400))]
            if draw.random() < 0.2:  # one too many, and it is wrong
                distances.insert(0, draw.choice((300, 2400)))
            for distance in [*distances, draw.choice((2850, 3000, 5000))]:
                yield now, "p", 0, 1
                yield now + int(us * draw.randrange(1, 100)), "p", 0, 0
                now += int(us * distance) + draw.randrange(8)

    return line
