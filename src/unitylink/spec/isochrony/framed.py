# SPDX-License-Identifier: BSD-3-Clause
"""The bound of a publish in a framed session.

Publishes come before requests, and several due publishes follow one another without a gap. Two things can be
in the way. One is a request that has just begun. The other is the line, because the transmitter has room for
only one payload beside the one that it sends. So there are three frames. A is being sent, B waits behind it,
and C is the reply of the request that has begun. C may wait until A has been sent, and the publish may wait
until B has been sent. While a publish waits for room, posts go on. The last of them may have just begun.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from unitylink import protocol as p

from .bound import Gateware, Isochrony, Occupation

_REQUEST_HEAD = 3  # bytes of LIST before its operations: id and flags
_POST_HEAD = 2
_GROUP_HEAD = 9  # bytes of DEFINE_GROUP before its addresses
_EXCHANGE_HEAD = 5
_REPLY_HEAD = 6  # bytes of LIST's reply before the words: id, posts, words
PUBLISH_HEAD = 7  # bytes: group, sequence, clock
_BETWEEN = 3  # clocks from a publish to another one that is due after it
_OPERATION = 2  # bytes of a list's operation: its kind, and how many words
_COUNTERS = p.CONTROL_DEADMAN_TRIPS - p.CONTROL_FRAMES + 1  # registers in READ_CONTROL's longest answer
_ANSWER = 4 + p.FRAMED_LATENCY_FRAME_BYTES  # bytes of a reply that only says that the request was done


@dataclass(frozen=True)
class _Request(Occupation):
    """A request.

    Its reply is written in `least` to `most` of its clocks. Before that, its form is checked.
    """

    least: int = 0
    most: int = 0


def isochrony(gateware: Gateware, *, words: int | None, before: Sequence[int], bus_waits: int) -> Isochrony:
    """Return idle time and bound.

    `words` is the most words of a list from the host. With None it is as many as fit.
    """
    a, d = -(-gateware.address_bits // 8), -(-gateware.data_bits // 8)
    requests, post = _requests(gateware, a, d, words, bus_waits)
    per_byte = max(1, gateware.byte_clocks)
    leaves = max(one.characters for one in requests) * per_byte
    late = max(
        *(one.clocks for one in requests),  # C, if the line is fast
        leaves + max(one.most for one in requests),  # A is being sent, B is short, then C
        # A and B are sent; A is sent while B is written
        *(leaves + one.characters * per_byte - one.least for one in requests),
    )
    late += post.clocks
    busy = late + leaves  # the line may be busy for so long when the first earlier publish begins
    for count in before:
        publish = _publish(count, d, bus_waits)
        room = max(late + publish.clocks, busy)
        late, busy = room + post.clocks, room + publish.characters * per_byte
    longest = max([*requests, post], key=lambda one: max(one.clocks, one.characters * per_byte))
    return Isochrony(
        p.FRAMED_LATENCY_TICK + gateware.groups,
        late,
        Occupation(longest.name, longest.clocks, longest.characters),
        gateware.clock_hz,
    )


def _requests(
    c: Gateware, a: int, d: int, words: int | None, bus_waits: int
) -> tuple[list[_Request], Occupation]:
    """Return the longest request of each kind, and the longest post."""
    told = (p.FRAMED_LATENCY_PAYLOAD_MAX - _REPLY_HEAD) // d  # words of the longest reply
    told = told if words is None else min(words, told)
    read = p.FRAMED_LATENCY_LIST_READ + 3 * a + d + bus_waits
    change = p.FRAMED_LATENCY_LIST_CHANGE + 2 * a + 2 * d + 2 * bus_waits
    reads = min(told, _fit(_REQUEST_HEAD, _OPERATION + a, words))
    changes = _fit(_REQUEST_HEAD, _OPERATION + a + d, words)
    checked = p.FRAMED_LATENCY_LIST_CHECK + a  # for each operation, before any reply

    def listed(operations: int, each: int, said: int, least: int) -> _Request:
        clocks = p.FRAMED_LATENCY_LIST + operations * each
        characters = _REPLY_HEAD + said * d + p.FRAMED_LATENCY_FRAME_BYTES
        return _Request("LIST", clocks, characters, least, clocks - operations * checked)

    group = p.FRAMED_LATENCY_DEFINE_GROUP_ADDRESS + 2 * max(a, 2)
    members = min(c.group_size, _fit(_GROUP_HEAD, a, None))
    exchange = p.FRAMED_LATENCY_DEFINE_EXCHANGE_WORD + (2 * a if a < 4 else 10)
    registers = _COUNTERS if words is None else min(words, _COUNTERS)
    requests = [
        listed(reads, read, reads, reads * d),
        # One operation has the longest reply in the shortest time. Then each word takes the bus and its
        # bytes.
        listed(1, told * (3 + d + bus_waits), told, told * (3 + d)),
        listed(changes, change, 0, 0),
        _Request("DEFINE_GROUP", p.FRAMED_LATENCY_DEFINE_GROUP + c.groups + members * group, _ANSWER),
        _Request(
            "DEFINE_EXCHANGE",
            p.FRAMED_LATENCY_DEFINE_EXCHANGE + _fit(_EXCHANGE_HEAD, a + 1, None) * exchange,
            _ANSWER,
        ),
        # READ_CONTROL of many registers takes longer, but less than DEFINE_EXCHANGE. No answer is longer.
        _Request("other", p.FRAMED_LATENCY_OTHER + bus_waits, _ANSWER + 4 * registers),
    ]
    changes = _fit(_POST_HEAD, _OPERATION + a + d, words)
    return requests, Occupation("POST_LIST", p.FRAMED_LATENCY_LIST + changes * change, 0)


def _fit(head: int, each: int, words: int | None) -> int:
    """Return how many parts of `each` bytes a request has after its head. They are at most `words`."""
    most = (p.FRAMED_LATENCY_PAYLOAD_MAX - head) // each
    return most if words is None else min(words, most)


def _publish(words: int, d: int, bus_waits: int) -> Occupation:
    clocks = _BETWEEN + p.FRAMED_LATENCY_PUBLISH + words * (p.FRAMED_LATENCY_PUBLISH_WORD + d + bus_waits)
    return Occupation("publish", clocks, PUBLISH_HEAD + words * d + p.FRAMED_LATENCY_FRAME_BYTES)
