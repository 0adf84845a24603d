# SPDX-License-Identifier: BSD-3-Clause
"""What a speed controller with bidirectional DShot puts on its line."""

from __future__ import annotations

import random
from collections.abc import Iterator

_CODES = (0x19, 0x1B, 0x12, 0x13, 0x1D, 0x15, 0x16, 0x17, 0x1A, 0x09, 0x0A, 0x0B, 0x1E, 0x0D, 0x0E, 0x0F)


def reply_of(period: int) -> int:
    """Return the 16 bits for 3 bits of exponent and 9 bits of mantissa of a period in us.

    >>> hex(reply_of(0xFFF)), hex(reply_of(0x264))
    ('0xfff0', '0x264f')
    """
    return period << 4 | (period >> 8 ^ period >> 4 ^ period ^ 0xF) & 0xF


def line_bits(reply: int) -> list[int]:
    """Return the 21 levels of the line, from the low start bit on.

    >>> hex(int("".join(map(str, line_bits(0xFFF0))), 2)), hex(int("".join(map(str, line_bits(0x264F))), 2))
    ('0x52951', '0xe6d35')
    """
    code = 0
    for place in (12, 8, 4, 0):
        code = code << 5 | _CODES[reply >> place & 0xF]
    levels = [0]
    for place in range(19, -1, -1):
        levels.append(levels[-1] ^ code >> place & 1)
    return levels


def replies_of_dshot(
    draw: random.Random, end: int, clock_hz: int = 2_300_000
) -> Iterator[tuple[int, str, int, int]]:
    """Yield replies of two speed controllers at 100 kbit/s, to rounds at 1100 Hz.

    A stimulus is as in `clock_true`. Replies are good, wrong or absent, and the line may ring before.
    """
    yield 0, "p", 0, 1
    yield 1, "p", 1, 1
    for round_ in range(1, end * 1100 // clock_hz):
        now = round_ * clock_hz / 1100
        for channel in (0, 1):
            now += 16 * 23
            kind = draw.choice(("good", "good", "early", "wrong", "none"))
            if kind == "early":  # the line rings
                yield int(now + 5 * clock_hz / 1e6), "p", channel, 0
                yield int(now + 8 * clock_hz / 1e6), "p", channel, 1
            now += draw.uniform(26, 40) * clock_hz / 1e6
            reply = reply_of(draw.choice((0xFFF, 0xFFE, 0xFFE, 1, draw.getrandbits(12))))
            if kind == "none":
                now += draw.uniform(11, 17) * clock_hz / 1e6 + 4 * 23
                continue
            bits = line_bits(reply ^ (kind == "wrong") << draw.randrange(16))
            length = 18.4 * draw.uniform(0.98, 1.02)
            for place, (before, level) in enumerate(zip([1, *bits], [*bits, 1], strict=True)):
                if level != before:
                    yield int(now + place * length), "p", channel, level
            now += 21 * 18.4 + 4 * 23 + 22
