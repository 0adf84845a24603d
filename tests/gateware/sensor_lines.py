# SPDX-License-Identifier: BSD-3-Clause
"""What sensors put on their lines, at the times at which they are asked. Their models tell when that is."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from gateware.clock_true import Stimulus, in_order

from unitylink import _native
from unitylink.interface.components import ComponentConfiguration

ANSWERS_MOST = 150  # each takes a play of the model


def changes_of(
    one: ComponentConfiguration, stimuli: Sequence[Stimulus], end: int, output: int = 0
) -> list[tuple[int, int]]:
    """Return the states in which an output of the model changes, and its levels from then on."""
    trace = _native.ComponentModel(one).play(in_order(stimuli, end), end)
    return [(at, value) for at, what, number, value in trace if (what, number) == ("o", output) and at < end]


def echoes(
    draw: random.Random, one: ComponentConfiguration, accesses: Sequence[Stimulus], end: int
) -> Iterator[Stimulus]:
    """Yield echoes behind triggers: short, long and stuck ones, spikes, and none."""
    generics = {name: int(value) for name, value in one.generics}
    us = generics["clock_hz"] / 1e6
    longest, period = us * generics["timeout_us"], us * generics["period_us"]
    found: list[Stimulus] = []
    heard = 0
    for _ in range(ANSWERS_MOST):
        falls = (at for at, level in changes_of(one, [*accesses, *found], end) if at > heard and not level)
        if (at := next(falls, None)) is None:
            break
        heard = at
        rises = at + int(draw.choice((1.0, 5.0, 100.0, 0.9 * period / us)) * us)
        length = draw.choice((0.1, 0.5, 0.9, 1.01)) * draw.choice((1.0, draw.random())) * longest
        if draw.random() < 0.1:
            length = draw.choice((1.1, 2.5)) * period
        if draw.random() < 0.3:
            found += [(rises - 1, "p", 0, 1), (rises + 1, "p", 0, 0)]  # a spike
            rises += int(3 * us)
        if draw.random() < 0.85:
            found += [(rises, "p", 0, 1), (rises + 1 + int(length), "p", 0, 0)]
            heard = max(at, rises + int(length))
    yield from found


def conversions(
    draw: random.Random, one: ComponentConfiguration, accesses: Sequence[Stimulus], end: int
) -> Iterator[Stimulus]:
    """Yield what an HX711 sends: conversions of any bits, the largest and the smallest, and a stuck line."""
    us = {name: int(value) for name, value in one.generics}["clock_hz"] / 1e6
    found: list[Stimulus] = [(0, "p", 0, 1), (int(90 * us), "p", 0, 0)]
    read = 0
    for _ in range(ANSWERS_MOST):
        rises = (at for at, level in changes_of(one, [*accesses, *found], end) if at > read and level)
        if (at := next(rises, None)) is None:
            break
        bits = draw.choice((draw.getrandbits(24), draw.getrandbits(24), 0x7FFFFF, 0x800000, 0xFFFFFF))
        line = [bits >> 23 - place & 1 for place in range(24)] + [int(draw.random() < 0.9)]
        found += [(at + int(2 * us * place), "p", 0, level) for place, level in enumerate(line)]
        read = at + int(60 * us)
        ready = read + int(draw.choice((1, 9, 60)) * us)
        found += [(read - 1, "p", 0, 1), (ready, "p", 0, 0)]
        if draw.random() < 0.2:
            found += [
                (ready + 2, "p", 0, 1),
                (ready + int(draw.choice((20, 400)) * us), "p", 0, 0),
            ]  # a spike
    yield from found


def crc8(data: bytes) -> int:
    """Return the check of 1-wire.

    >>> crc8(bytes.fromhex("9101 4B46 7FFF 0C10")) == 0x70, crc8(bytes.fromhex("5005 4B46 7FFF 0C10")) == 0x1C
    (True, True)
    """
    crc = 0
    for byte in data:
        for place in range(8):
            crc = crc >> 1 ^ (0x8C if (crc ^ byte >> place) & 1 else 0)
    return crc


def thermometer(
    draw: random.Random, one: ComponentConfiguration, _accesses: Sequence[Stimulus], end: int
) -> Iterator[Stimulus]:
    """Yield what a DS18B20 sends to `one_wire`, for a clock of 1 MHz, in which a tick is a clock.

    The tries begin where the periods do, and their slots follow from what is sent. Some have no presence, a
    short, a wrong bit, no marks, or no conversion.
    """
    facts = {name: int(value) for name, value in one.generics}
    unit, slot, reset = 8, 70, 122
    period = facts["period_ms"] * 1000
    yield 0, "p", 0, 1
    for begin in range(unit, end, period):
        kind = draw.choice(("good", "good", "good", "wrong", "unmarked", "away", "short", "idle", "endless"))
        at = begin
        for part, sent in enumerate((5, 2, 2)):
            start = (at // unit + 1) * unit
            if kind == "short" and part == 1:
                yield start, "p", 0, 0
                yield start + reset * unit + 40, "p", 0, 1
                break
            if kind == "away" and part == draw.randrange(3):
                break
            yield start + 61 * unit + 30, "p", 0, 0
            yield start + 61 * unit + 150, "p", 0, 1
            at = start + (reset - 1) * unit + sent * 8 * slot
            if part == 1 and facts["parasite"]:
                converted = begin + (94 + 10) * 1000
                while at <= converted:
                    at += slot
            elif part == 1 and kind == "endless":
                yield at, "p", 0, 0
                yield begin + period - 3, "p", 0, 1
                break
            elif part == 1:
                busy = 0 if kind == "idle" else draw.randrange(1, 40)
                yield at + 2, "p", 0, int(not busy)
                yield at + busy * slot + 2, "p", 0, 1
                at += (busy + 1) * slot
        else:
            text = bytearray(draw.randbytes(2) + b"\x69\x69\x1f\xff\x0c\x10")
            if kind == "unmarked":
                text[draw.choice((2, 3))] ^= 1 << draw.randrange(8)
            text.append(crc8(bytes(text)))
            if kind == "wrong":
                text[draw.randrange(9)] ^= 1 << draw.randrange(8)
            for place in range(72):
                if not text[place // 8] >> place % 8 & 1:
                    yield at + place * slot + 2, "p", 0, 0
                    yield at + place * slot + 32, "p", 0, 1
