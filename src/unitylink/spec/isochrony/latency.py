# SPDX-License-Identifier: BSD-3-Clause
"""How late each publish of a device can be, from the gateware's earlier work and the time on the line."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from unitylink import protocol as constants

from ..model import Device, SubscriptionGroup
from . import isochrony
from .framed import PUBLISH_HEAD

BITS_PER_BYTE = 10  # on the line: start, eight data, stop
UART_FIFO_BYTES = 16  # bytes in the gateware's transmitter that were written before and still wait
_ROUNDS_MAX = 100  # the most rounds of the fixed-point search, and
# the most messages that it may put before a publish; beyond this, the line is as good as full
_MESSAGES_MAX = 1_000


_Kind = tuple[float, int, int]  # (period in s, words, bytes) of a publish; equal ones have equal delays


@dataclass(frozen=True)
class Latency:
    """The longest times from the tick (or event) of a publish: until its first word is sampled, and until its
    last byte has been sent.

    Both are None if the next publish may be due before this one is done.
    """

    sampled_s: float | None
    sent_s: float | None


@dataclass(frozen=True)
class _Gateware:
    """The gateware of a device, as far as its timing matters. See isochrony.Gateware."""

    address_bits: int
    data_bits: int
    groups: int
    group_size: int
    rate_bytes: int
    byte_clocks: int
    protocol: str
    clock_hz: int
    read_many: int = constants.READ_MANY_MAX
    publish_mode: int = 2
    datalink: str = "full"
    checksum: str = "crc8"
    engine: str = "fast"


def publishes_of(words: int, data_bits: int, protocol: str) -> list[int]:
    """Return the words of each message in which a group is published.

    In frames there may be several messages.

    >>> publishes_of(70, 32, "framed"), publishes_of(70, 32, "classic")
    ([60, 10], [70])
    """
    framed = (constants.FRAMED_LATENCY_PAYLOAD_MAX - PUBLISH_HEAD) // (data_bits // 8)
    most = words if protocol == "classic" else framed
    return [min(most, words - start) for start in range(0, words, max(1, most))]


def period_s(group: SubscriptionGroup, base_hz: int) -> float:
    """Return the time between two publishes. It is infinite for an event whose rate is unknown."""
    if group.divisor:
        return group.divisor / base_hz
    return 1 / group.rate_hz if group.rate_hz else math.inf


def latencies(
    device: Device,
    message_bytes: Sequence[int],
    baud_hz: int,
    read_many: int,
    *,
    protocol: str,
    clock_hz: int,
    engine: str | None = None,
) -> list[Latency]:
    """Return the bounds of each group of `device`. Its publishes have `message_bytes` each.

    They hold for the generated gateware at `clock_hz`, whatever requests of up to `read_many` words come in
    by `protocol`. `engine` is that of the design. None means the one that the spec's link asks for, or else
    the fast one. Every other group comes first, as often as it is due meanwhile. A group with an event comes
    once.
    """
    groups, base_hz = device.groups, device.link.base_hz
    never = [Latency(None, None)] * len(groups)
    periods = [period_s(group, base_hz) for group in groups]
    rated = sum(cost / period for period, cost in zip(periods, message_bytes, strict=True))
    if rated * BITS_PER_BYTE > baud_hz:
        return never
    gateware = _gateware(device, baud_hz, protocol, clock_hz, engine or device.link.engine or "fast")
    kinds = [
        (period, len(group.addresses), cost)
        for period, group, cost in zip(periods, groups, message_bytes, strict=True)
    ]
    there = Counter(kinds)
    known = {kind: _latency(gateware, kind, there - Counter([kind]), baud_hz, read_many) for kind in there}
    return [known[kind] for kind in kinds]


def _gateware(device: Device, baud_hz: int, protocol: str, clock_hz: int, engine: str) -> _Gateware:
    """Return the gateware that the generator makes.

    Without a stated address width, the largest is assumed.
    """
    link = device.link
    plain_groups, plain_size = constants.GROUPS_2012, constants.GROUP_SIZE_2012
    return _Gateware(
        address_bits=link.address_bits or constants.ADDRESS_BITS_MAX,
        data_bits=link.data_bits,
        groups=max(plain_groups, len(device.groups)),
        group_size=max([plain_size, *(len(group.addresses) for group in device.groups)]),
        rate_bytes=constants.RATE_BYTES_MAX,
        byte_clocks=-(-clock_hz * BITS_PER_BYTE // baud_hz),
        protocol=protocol,
        clock_hz=clock_hz,
        engine=engine,
    )


def _latency(
    gateware: _Gateware, kind: _Kind, others: Counter[_Kind], baud_hz: int, read_many: int
) -> Latency:
    """Return the time that all earlier publishes and requests take.

    Return None if the next one is due before that.
    """
    period_s, words, message_bytes = kind
    own_clocks = words * (constants.LATENCY_PUBLISH_WORD + -(-gateware.data_bits // 8))
    own_s = (message_bytes + UART_FIFO_BYTES) * BITS_PER_BYTE / baud_hz + own_clocks / gateware.clock_hz
    sent_s = 0.0
    for _ in range(_ROUNDS_MAX):
        due = [(one, count * max(1, math.ceil(sent_s / one[0]))) for one, count in others.items()]
        if sum(count for _, count in due) > _MESSAGES_MAX:
            break
        before = [
            part
            for one, count in due
            for part in publishes_of(one[1], gateware.data_bits, gateware.protocol) * count
        ]
        found = isochrony(gateware, read_many=read_many, before=before)
        sampled_s = found.bound_clocks / found.clock_hz
        if sampled_s + own_s > period_s:
            break
        if sampled_s + own_s <= sent_s:
            return Latency(sampled_s, sent_s)
        sent_s = sampled_s + own_s
    return Latency(None, None)
