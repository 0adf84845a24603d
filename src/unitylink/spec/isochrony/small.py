# SPDX-License-Identifier: BSD-3-Clause
"""The bound of a publish by the small engine of the framed protocol.

Its program does one thing after another, and has room for one message. So a publish may have to wait for a
request that has just begun, then for the reply of this request to leave, and then for a frame that is being
checked, or a post. Publishes go before the next request.
"""

from __future__ import annotations

from collections.abc import Sequence

from unitylink import protocol as p

from .bound import Gateware, Isochrony, Occupation
from .framed import PUBLISH_HEAD

_REPLY_HEAD = 4  # bytes of READ_CONTROL's reply before the registers: id and posts
_COUNTERS = p.CONTROL_DEADMAN_TRIPS - p.CONTROL_FRAMES + 1  # registers in the longest reply
_SEND_CLOCKS = 2  # of a byte, on a line that takes it at once


def isochrony(gateware: Gateware, *, words: int | None, before: Sequence[int], bus_waits: int) -> Isochrony:
    """Return idle time and bound.

    The idle time is the shortest one: the program may be anywhere in its loop. `words` is the most registers
    in a request of the host. With None it is as many as there are.
    """
    a, d = -(-gateware.address_bits // 8), -(-gateware.data_bits // 8)
    per_byte = max(_SEND_CLOCKS, gateware.byte_clocks)
    registers = _COUNTERS if words is None else min(words, _COUNTERS)
    characters = _REPLY_HEAD + 4 * registers + p.FRAMED_LATENCY_FRAME_BYTES
    longest = Occupation("READ_CONTROL", p.SMALL_LATENCY_REQUEST + bus_waits, characters)
    between = p.SMALL_LATENCY_CHECK + bus_waits
    late = p.SMALL_LATENCY_TICK_JITTER + p.SMALL_LATENCY_SCAN * gateware.groups
    late += longest.clocks + characters * per_byte + between
    for count in before:
        publish = publish_of(count, a, d, bus_waits)
        late += publish.clocks + publish.characters * per_byte + between
    idle = p.SMALL_LATENCY_TICK + p.SMALL_LATENCY_TICK_GROUP * gateware.groups
    return Isochrony(idle + p.SMALL_LATENCY_TICK_ADDRESS_BYTE * a, late, longest, gateware.clock_hz)


def publish_of(words: int, a: int, d: int, bus_waits: int = 0) -> Occupation:
    """Return what a publish costs: clocks of the program, and bytes that leave after them.

    >>> publish_of(1, 2, 4)
    Occupation(name='publish', clocks=818, characters=17)
    """
    each = p.SMALL_LATENCY_PUBLISH_WORD + p.SMALL_LATENCY_PUBLISH_DATA_BYTE * d
    each += p.SMALL_LATENCY_PUBLISH_ADDRESS_BYTE * a + bus_waits
    characters = PUBLISH_HEAD + words * d + p.FRAMED_LATENCY_FRAME_BYTES
    return Occupation("publish", p.SMALL_LATENCY_PUBLISH + words * each, characters)
