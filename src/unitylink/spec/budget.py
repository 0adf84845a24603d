# SPDX-License-Identifier: BSD-3-Clause
"""What the publishes of a spec cost on the line: bytes, load, the highest rate, and how late each can come.

All figures follow from the constants of the protocol and the compiler's table of subscription groups
(`Spec.devices`); the tests compare them with what the twin really sends.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from .. import protocol
from .model import Device, SubscriptionGroup

USUAL_BAUD_HZ = (115_200, 230_400, 460_800, 921_600, 1_000_000, 2_000_000, 3_000_000, 6_000_000, 12_000_000)
BITS_PER_BYTE = 10  # on the line: start, eight data, stop
_ROUNDS_MAX = 1_000  # of the latency's fixed point; beyond, the line is as good as full


def message_bytes(letters: int, data_bytes: int, checked: bool = False) -> int:
    """Return the bytes of a message: head, letters, `:`, two digits a byte, checksum, end of line.

    >>> message_bytes(len("PUB"), 2 + 4)  # %PUB:ggnn........
    18
    """
    return 1 + letters + 1 + 2 * data_bytes + (3 if checked else 0) + 1


def publish_bytes(words: int, data_bits: int, checked: bool = False) -> int:
    """Return the bytes of a publish of `words` words: its data begin with the group and the count."""
    return message_bytes(len(protocol.REPLY_PUBLISH), 2 + words * data_bits // 8, checked)


@dataclass(frozen=True)
class GroupBudget:
    """One subscription group. `rate_hz` is None where an event triggers: how often, nobody knows here.

    `latency_s` bounds the time from the tick (or event) to the last byte on the line, None without a baud
    rate or where the line is overloaded.
    """

    number: int
    name: str
    rate_hz: float | None
    words: int
    message_bytes: int
    paths: tuple[str, ...]
    latency_s: float | None

    @property
    def bytes_per_s(self) -> float:
        return self.message_bytes * self.rate_hz if self.rate_hz else 0.0


@dataclass(frozen=True)
class BaudBudget:
    """One baud rate: the share of the line the publishes take, and the highest common rate that would fit.

    `highest_hz` is a base rate / divisor at which every group with a rate could publish; None where not even
    the slowest fits.
    """

    baud_hz: int
    load: float
    highest_hz: float | None


@dataclass(frozen=True)
class DeviceBudget:
    """One device of a spec. `tick_bytes` are sent at a base tick at which all groups with a rate are due."""

    root: str
    link: str
    data_bits: int
    base_hz: int
    baud_hz: int | None
    checked: bool
    groups: tuple[GroupBudget, ...]
    bauds: tuple[BaudBudget, ...]
    read_many: int

    @property
    def tick_bytes(self) -> int:
        return sum(group.message_bytes for group in self.groups if group.rate_hz)

    @property
    def bytes_per_s(self) -> float:
        return sum(group.bytes_per_s for group in self.groups)

    @property
    def load(self) -> float | None:
        """The share of the line at the link's baud rate; None without one."""
        return self.bytes_per_s * BITS_PER_BYTE / self.baud_hz if self.baud_hz else None

    @property
    def fits_2012(self) -> bool:
        """Whether the 2012 gateware has room for the groups without dividing one."""
        return len(self.groups) <= protocol.GROUPS_2012 and all(
            group.words < protocol.GROUP_SIZE_2012 for group in self.groups
        )


def budget(
    device: Device, *, baud_hz: int | None = None, checked: bool = False, read_many: int | None = None
) -> DeviceBudget:
    """Return the budget of a device, at the declared baud rate or another one.

    `checked` counts publishes with a checksum. A reply of `read_many` words may be on the line when a publish
    is due; no more than one, as publishes go first.
    """
    link = device.link
    baud_hz = baud_hz if baud_hz is not None else link.baud_hz
    read_many = read_many if read_many is not None else protocol.READ_MANY_MAX
    costs = [publish_bytes(len(group.addresses), link.data_bits, checked) for group in device.groups]
    reply = message_bytes(len(protocol.REPLY_READ_MANY), read_many * link.data_bits // 8, checked)
    latencies = _latencies(device.groups, costs, reply, link.base_hz, baud_hz)
    groups = tuple(
        GroupBudget(
            number=group.number,
            name=group.name,
            rate_hz=link.base_hz / group.divisor if group.divisor else None,
            words=len(group.addresses),
            message_bytes=cost,
            paths=tuple(element.path for element in group.elements),
            latency_s=latency,
        )
        for group, cost, latency in zip(device.groups, costs, latencies, strict=True)
    )
    bytes_per_s = sum(group.bytes_per_s for group in groups)
    together = sum(group.message_bytes for group in groups if group.rate_hz)
    rates = sorted({*USUAL_BAUD_HZ, *([baud_hz] if baud_hz else [])})
    bauds = tuple(
        BaudBudget(baud, bytes_per_s * BITS_PER_BYTE / baud, _highest_hz(together, link.base_hz, baud))
        for baud in rates
    )
    return DeviceBudget(
        root=device.root,
        link=link.name,
        data_bits=link.data_bits,
        base_hz=link.base_hz,
        baud_hz=baud_hz,
        checked=checked,
        groups=groups,
        bauds=bauds,
        read_many=read_many,
    )


def _highest_hz(bytes_each: int, base_hz: int, baud_hz: int) -> float | None:
    if not bytes_each:
        return None
    divisor = max(1, math.ceil(bytes_each * BITS_PER_BYTE * base_hz / baud_hz))
    slowest = (1 << 8 * protocol.RATE_BYTES_MAX) - 1
    return base_hz / divisor if divisor <= slowest else None


def _latencies(
    groups: Sequence[SubscriptionGroup],
    costs: Sequence[int],
    reply: int,
    base_hz: int,
    baud_hz: int | None,
) -> list[float | None]:
    """Bound how late each publish can be done, in whatever order the gateware serves what is due.

    When a group is due, one other message may have just begun, and every other group may be due as well, and
    again and again as long as this one waits. An event is counted once.
    """
    if not baud_hz:
        return [None] * len(groups)
    byte_s = BITS_PER_BYTE / baud_hz
    periods_s = [group.divisor / base_hz if group.divisor else math.inf for group in groups]
    longest = max([reply, *costs]) * byte_s
    found: list[float | None] = []
    for mine, cost in enumerate(costs):
        pairs = zip(periods_s, costs, strict=True)
        others = [(period_s, c * byte_s) for i, (period_s, c) in enumerate(pairs) if i != mine]
        found.append(_fixed_point(longest + cost * byte_s, others, periods_s[mine]))
    return found


def _fixed_point(start_s: float, others: list[tuple[float, float]], period_s: float) -> float | None:
    waited_s = start_s
    for _ in range(_ROUNDS_MAX):
        again_s = start_s + sum(max(1, math.ceil(waited_s / period)) * cost for period, cost in others)
        if again_s > period_s:
            return None  # the next one would be due before this one is out
        if again_s <= waited_s:
            return again_s
        waited_s = again_s
    return None
