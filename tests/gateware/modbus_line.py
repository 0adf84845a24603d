# SPDX-License-Identifier: BSD-3-Clause
"""What devices of Modbus RTU put on the line of `modbus_master`, at the times at which they are asked."""

from __future__ import annotations

import random
from collections.abc import Iterator, Sequence

from gateware.clock_true import Stimulus, in_order
from gateware.servo_line import changes, sent

from unitylink import _native
from unitylink.interface.components import ComponentConfiguration

KINDS = (
    "good",
    "good",
    "good",
    "good",
    "wrong",
    "wrong",
    "wrong",
    "short",
    "long",
    "other",
    "refused",
    "none",
    "broken",
)
# Three registers of the unit 17 are read, and the register 1 of the unit 1 gets an output.
ORDERS = (
    "C0E8C403C000D800C088C413C800"
    + "201100030000006B00000003481148034806"
    + "0D000C010D000C010D001C01"
    + "E023200100060000000185008000480148064800480108001800D004"
)


def crc16(data: bytes) -> bytes:
    """Return the check of Modbus.

    >>> crc16(b"123456789").hex(), crc16(bytes.fromhex("1103006B0003")).hex()
    ('374b', '7687')
    """
    crc = 0xFFFF
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = crc >> 1 ^ 0xA001 if crc & 1 else crc >> 1
    return crc.to_bytes(2, "little")


def replies_of_modbus(
    draw: random.Random, one: ComponentConfiguration, accesses: Sequence[Stimulus], end: int
) -> Iterator[Stimulus]:
    """Yield the replies to each request of the model: good, wrong, broken, or none."""
    generics = dict(one.generics)
    bit = int(generics["clock_hz"]) / int(generics["baud_hz"])
    parity = int(generics["parity"])
    step = int(generics["timeout_us"]) * int(generics["clock_hz"]) // 1_000_000
    found: list[Stimulus] = [(0, "p", 0, 1)]
    handled, now = 0, step
    while now < end:
        trace = _native.ComponentModel(one).play(in_order([*accesses, *found], now), now)
        bits = 10 + bool(parity)
        asked = next(sent([one for one in trace if one[0] > handled], bit, bits), None)
        if asked is None:
            now += step
            continue
        handled, text = asked
        late = draw.choice((0.1, 0.3, 0.6, 1.0, 1.4)) * draw.random() * step
        levels = _levels(draw, _answer(draw, text), parity)
        found += changes(handled + 2 + late, bit * draw.uniform(0.98, 1.02), levels)
    yield from (one for one in found if one[0] < end - 20)


def _answer(draw: random.Random, request: bytes) -> bytes:
    kind = draw.choice(KINDS)
    unit, function = request[0] ^ (kind == "other"), request[1]
    body = bytes([unit, function])
    if kind == "refused":
        body = bytes([unit, function | 0x80, draw.randrange(1, 12)])
    elif function in (3, 4):
        count = 2 * request[5]
        body += bytes([count]) + draw.randbytes(count)
    else:
        body += request[2:6]
    frame = bytearray(body + crc16(body))
    if kind == "wrong":
        frame[draw.randrange(len(frame))] ^= 1 << draw.randrange(8)
    elif kind == "short":
        del frame[draw.randrange(len(frame)) :]
    elif kind == "long":
        frame += draw.randbytes(3)
    elif kind == "none":
        frame.clear()
    return bytes(frame)


def _levels(draw: random.Random, frame: bytes, parity: int) -> list[int]:
    broken = draw.randrange(60)
    found = []
    for place, byte in enumerate(frame):
        data = [byte >> bit & 1 for bit in range(8)]
        check = [sum(data) % 2 ^ (parity == 2) ^ (place == broken)] if parity else []
        found += [0, *data, *check, 1]
    return found
