# SPDX-License-Identifier: BSD-3-Clause
"""The bound of a publish if the link uses the classic protocol."""

from __future__ import annotations

from collections.abc import Sequence

from unitylink import protocol
from unitylink.errors import ValueRangeError

from .bound import Gateware, Isochrony, Occupation

_CHECKSUM_CHARACTERS = 3
_CONFIGURATION_CHARACTERS = 34  # characters of CNF, with a base frequency of four bytes


def isochrony(
    gateware: Gateware, *, read_many: int | None, before: Sequence[int], checked: bool, bus_waits: int
) -> Isochrony:
    """Return idle time and bound.

    `read_many` is the longest read-many that the host sends. With None it is the longest possible.
    """
    c = gateware
    if c.datalink != "full":
        raise ValueRangeError(
            f"isochrony: datalink is {c.datalink!r}; only 'full' has a bound, the others wait for the host"
        )
    words = c.read_many if read_many is None else read_many
    if not 0 <= words <= c.read_many:
        raise ValueRangeError(f"isochrony: read_many is {words}; choose 0 to {c.read_many}")
    address_bytes, data_bytes = -(-c.address_bits // 8), -(-c.data_bits // 8)
    tail = 1 + (_CHECKSUM_CHARACTERS if checked and c.checksum != "none" else 0)
    requests = [
        Occupation(
            "R", protocol.LATENCY_READ + address_bytes + data_bytes + bus_waits, 5 + 2 * data_bytes + tail
        ),
        Occupation(
            "RM",
            protocol.LATENCY_READ_MANY
            + words * (protocol.LATENCY_READ_MANY_WORD + address_bytes + data_bytes + bus_waits),
            6 + 2 * data_bytes * words + tail,
        ),
        Occupation(
            "WSA",
            protocol.LATENCY_GROUP_ADDRESSES
            + c.group_size * (protocol.LATENCY_GROUP_ADDRESS + 2 * address_bytes),
            6 + tail,
        ),
        Occupation(
            "RSI",
            protocol.LATENCY_READ_GROUP
            + c.group_size * (protocol.LATENCY_READ_GROUP_ADDRESS + address_bytes),
            7 + 2 * (c.rate_bytes + 1 + address_bytes * c.group_size) + tail,
        ),
    ]
    mask_bytes = max(protocol.EVENT_MASK_BYTES_MIN, -(-c.groups // 8))
    requests += [
        Occupation("RLC", protocol.LATENCY_OTHER, _CONFIGURATION_CHARACTERS + tail),
        Occupation("WIC", protocol.LATENCY_OTHER + 3 * mask_bytes, 6 + tail),
        Occupation("RIC", protocol.LATENCY_OTHER + mask_bytes, 7 + 2 * mask_bytes + tail),
    ]
    publishes = [
        Occupation(
            "PUB",
            protocol.LATENCY_PUBLISH
            + address_bytes
            + count * (protocol.LATENCY_PUBLISH_WORD + data_bytes + bus_waits),
            9 + 2 * data_bytes * count + tail,
        )
        for count in before
    ]
    late, longest = max(
        ((_clocks(_in_the_way(one, publishes, c.publish_mode), c.byte_clocks), one) for one in requests),
        key=lambda pair: pair[0],
    )
    return Isochrony(protocol.LATENCY_TICK + c.groups + address_bytes, late, longest, c.clock_hz)


def _in_the_way(request: Occupation, publishes: list[Occupation], publish_mode: int) -> list[Occupation]:
    """Return the messages that can come before a publish if requests come without end."""
    turns = protocol.LATENCY_TURNS_MOST
    if publish_mode == 1:  # requests come first, so each publish waits for a row of them
        row = [request] * turns
        return [request, *row, *(one for publish in publishes for one in (publish, *row))]
    found = [request]
    for number, publish in enumerate(publishes, start=1):
        found.append(publish)
        if number % turns == 0:
            found.append(request)
    return found


def _clocks(messages: list[Occupation], byte_clocks: int) -> int:
    """Return how long a row of messages keeps the next one from the bus.

    The slower side decides: the application, or the line. If it is the line, earlier bytes wait in the FIFO
    between the two. A publish puts a few words behind these bytes before it asks for the bus.
    """
    words = protocol.LATENCY_PUBLISH_WORDS_BEFORE
    per_character = max(1, byte_clocks)
    line = sum(one.characters for one in messages) + 2 * words
    return max(sum(one.clocks for one in messages), line * per_character - words)
