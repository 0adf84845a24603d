# SPDX-License-Identifier: BSD-3-Clause
"""What comes by the wires of a component: values that change as a whole, and are seldom not valid."""

from __future__ import annotations

import random
from collections.abc import Callable, Iterator

from unitylink_lab.conformance.component_ports import WIRE_BITS

Stimulus = tuple[int, str, int, int]
VALID = 1 << WIRE_BITS - 1


def random_wires(
    wires: int, pause: int, pins: int = 0, lost: float = 0.02, high: float = 0.1
) -> Callable[[random.Random, int], Iterator[Stimulus]]:
    """Return a generator for `wires` wires behind `pins` pins.

    Something changes every `pause` clocks at most. A change makes a wire end with the probability `lost`. The
    next one makes it valid again, or comes soon. A pin is high with the probability
    `high`.

    >>> (at, kind, pin, level), *_ = random_wires(1, 9)(random.Random(1), 100)
    >>> kind, level
    ('p', 1)
    """

    def changes(draw: random.Random, end: int) -> Iterator[Stimulus]:
        levels = [0] * (pins + wires)
        now = 4
        while now < end - 20:
            ended = [one for one in range(pins, pins + wires) if not levels[one] & VALID]
            one = draw.choice(ended) if ended and draw.random() < 0.7 else draw.randrange(pins + wires)
            value = int(draw.random() < high)
            if one >= pins:
                value = draw.getrandbits(draw.choice((8, 13, 17, 32)))
                if draw.random() < 0.5:
                    value = -value & 0xFFFFFFFF
                value |= VALID * (draw.random() >= lost)
            for bit in range(WIRE_BITS if one >= pins else 1):
                if (levels[one] ^ value) >> bit & 1:
                    pin = one if one < pins else pins + (one - pins) * WIRE_BITS + bit
                    yield now, "p", pin, value >> bit & 1
            levels[one] = value
            now += draw.randrange(1, 9 if ended else pause)

    return changes
