# SPDX-License-Identifier: BSD-3-Clause
"""What bus servos put on the line of `servo_bus`, at the times at which they are asked."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from gateware.clock_true import Stimulus, in_order

from unitylink import _native
from unitylink.interface.components import ComponentConfiguration

KINDS = ("good", "good", "good", "signs", "wrong", "noise", "short", "other", "error", "none")


def crc16(data: bytes) -> bytes:
    """Return the check of Dynamixel 2.0.

    >>> crc16(b"123456789").hex(), crc16(bytes.fromhex("FFFFFD0001030001")).hex()
    ('e8fe', '194e')
    """
    crc = 0
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = crc << 1 ^ 0x8005 if crc & 0x8000 else crc << 1
        crc &= 0xFFFF
    return crc.to_bytes(2, "little")


def reply(protocol: int, number: int, alarm: int, data: bytes) -> bytes:
    """Return the reply of the servo `number` with its data.

    >>> reply(1, 1, 0, bytes.fromhex("0008")).hex(), reply(0, 1, 0, bytes.fromhex("A6000000")).hex()
    ('ffff0104000008f2', 'fffffd000108005500a60000008cc0')
    """
    if protocol:
        body = bytes([number, len(data) + 2, alarm]) + data
        return b"\xff\xff" + body + bytes([~sum(body) & 0xFF])
    text = (bytes([0x55, alarm]) + data).replace(b"\xff\xff\xfd", b"\xff\xff\xfd\xfd")
    head = b"\xff\xff\xfd\x00" + bytes([number]) + (len(text) + 2).to_bytes(2, "little") + text
    return head + crc16(head)


def levels(data: bytes) -> Iterator[int]:
    """Yield the bits of bytes on the line: a start bit, eight bits, a stop bit."""
    for byte in data:
        yield 0
        yield from (byte >> bit & 1 for bit in range(8))
        yield 1


def changes(start: float, bit: float, bits: Sequence[int], pin: int = 0) -> Iterator[Stimulus]:
    """Yield the changes of a pin that is high at rest."""
    before = 1
    for place, level in enumerate([*bits, 1]):
        if level != before:
            yield int(start + place * bit), "p", pin, level
        before = level


def sent(trace: Sequence[Stimulus], bit: float, bits_of_byte: int = 10) -> Iterator[tuple[int, bytes]]:
    """Yield what was sent, and when its driver was switched off."""
    line = [(state, value) for state, what, number, value in trace if (what, number) == ("o", 0)]
    begun = 0
    for state, what, number, value in trace:
        if (what, number, value) == ("o", 1, 1):
            begun = state
        elif (what, number, value) == ("o", 1, 0):
            found, at = bytearray(), begun
            while (fall := next((s for s, v in line if at <= s < state and v == 0), None)) is not None:
                bits = [[v for s, v in line if s <= fall + (place + 1.5) * bit][-1] for place in range(8)]
                found.append(sum(level << place for place, level in enumerate(bits)))
                at = int(fall + (bits_of_byte - 0.5) * bit)
            yield state, bytes(found)


def replies_of_servos(
    draw: random.Random, one: ComponentConfiguration, accesses: Sequence[Stimulus], end: int
) -> Iterator[Stimulus]:
    """Yield the replies to each question that the model asks: good, wrong, broken, or none."""
    generics = {name: int(value) for name, value in one.generics}
    protocol = generics["protocol"]
    bit = generics["clock_hz"] / generics["baud_hz"]
    step = generics["timeout_us"] * generics["clock_hz"] // 1_000_000
    found: list[Stimulus] = [(0, "p", 0, 1)]
    handled = 0
    now = step
    while now < end:
        trace = _native.ComponentModel(one).play(in_order([*accesses, *found], now), now)
        packets = sent([one for one in trace if one[0] > handled], bit)
        asked = next(packets, None)
        if asked is None:
            now += step
            continue
        handled, text = asked
        if text[4 if protocol else 7] == 2:
            bits = _answer(draw, protocol, text[2 if protocol else 4])
            late = draw.choice((0.2, 0.5, 0.9, 1.1)) * draw.random() * step
            found += changes(handled + 2 + late, bit * draw.uniform(0.98, 1.02), bits)
    yield from (one for one in found if one[0] < end - 20)


def _answer(draw: random.Random, protocol: int, number: int) -> list[int]:
    kind = draw.choice(KINDS)
    data = draw.randbytes(6 if protocol else 10)
    if kind == "signs":
        data = bytes.fromhex("FF80018000FC" if protocol else "01FFFFFD020304FFFFFD")
    alarm = draw.choice((0, 0, 0x80, draw.getrandbits(8)))
    frame = bytearray(reply(protocol, number ^ (kind == "other"), alarm, b"" if kind == "error" else data))
    if kind == "wrong":
        frame[draw.randrange(len(frame))] ^= 1 << draw.randrange(8)
    elif kind == "noise":
        frame[:0] = draw.choice((b"\xff", b"\x00", b"\xff\xff\xff", b"\x55\xff"))
    elif kind == "short":
        del frame[draw.randrange(len(frame)) :]
    elif kind == "none":
        frame.clear()
    bits = list(levels(bytes(frame)))
    if kind == "wrong" and draw.random() < 0.3:
        bits[9] = 0  # no stop bit
    return bits
