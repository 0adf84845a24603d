# SPDX-License-Identifier: BSD-3-Clause
"""What an absolute encoder puts on its line, for a reader whose clocks are known."""

from __future__ import annotations

import random
from collections.abc import Iterator

CLOCK_HZ = 2_300_000
HALF = 4  # clocks of half a period, at 300 kHz
SAMPLE_HZ = 7000
BITS = 9  # of the position, BiSS-C
PAUSE = 4  # clocks around a frame of SPI
Stimulus = tuple[int, str, int, int]


def crc_of(bits: list[int]) -> list[int]:
    """Return the CRC-6 of polynomial 43 as BiSS-C sends it.

    >>> crc_of([0] * 26 + [1, 1])  # 3A
    [1, 1, 1, 0, 1, 0]
    """
    crc = 0
    for bit in bits:
        top = crc >> 5 ^ bit
        crc = crc << 1 & 0x3F ^ 3 * top
    return [~crc >> place & 1 for place in range(5, -1, -1)]


def _begins(end: int) -> Iterator[int]:
    """Yield the clocks at which readings begin."""
    for number in range(1, end * SAMPLE_HZ // CLOCK_HZ):
        yield number * CLOCK_HZ // SAMPLE_HZ + 3


def _levels(begin: float, bits: list[int], length: float) -> Iterator[Stimulus]:
    """Yield the changes of the line for these bits, and high at their end."""
    for place, (before, bit) in enumerate(zip([1, *bits], [*bits, 1], strict=True)):
        if bit != before:
            yield int(begin + place * length), "p", 0, bit


def frames_of_biss(draw: random.Random, end: int) -> Iterator[Stimulus]:
    """Yield frames of BiSS-C. Some have a wrong bit, an error or a warning, come too late, or do not come."""
    yield 0, "p", 0, 1
    for begin in _begins(end):
        position = [draw.randrange(2) for _ in range(BITS)]
        data = [*position, int(draw.random() < 0.8), draw.randrange(2)]
        data += crc_of(data)
        if draw.random() < 0.2:
            data[draw.randrange(len(data))] ^= 1
        kind = draw.choice(("good", "good", "good", "late", "none"))
        first = begin + draw.randrange(8, 20)
        if kind == "none":
            continue
        acknowledge = draw.randrange(1, 4) + (7 if kind == "late" else 0)
        yield from _levels(first, [0] * acknowledge + [1, 0, *data, 0], 2 * HALF)


def frames_of_as5047p(draw: random.Random, end: int) -> Iterator[Stimulus]:
    """Yield both replies of each reading. Some have a wrong parity, an error, or are FFFF or 0000."""
    yield 0, "p", 0, 1
    frame = 3 * PAUSE + 32 * HALF
    for begin in _begins(end):
        for number in (0, 1):
            good = draw.random() < 0.9
            value = draw.getrandbits(14)
            if not good:
                value |= draw.choice((0, 0, 1)) << 14
            word = value | value.bit_count() % 2 << 15
            if not good:
                word = draw.choice((word, word ^ 1 << draw.randrange(16), 0, 0, 0, 0xFFFF))
            bits = [word >> place & 1 for place in range(15, -1, -1)]
            yield from _levels(begin + number * frame + PAUSE + 1, bits, 2 * HALF)
