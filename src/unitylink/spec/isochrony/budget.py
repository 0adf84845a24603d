# SPDX-License-Identifier: BSD-3-Clause
"""The cost of a spec's publishes on the line: bytes, load, the highest rate, and the longest delays.

All figures follow from the constants of the protocol and from the compiler's tables of subscription groups
(`Spec.devices`). The tests compare them with what the twin sends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from unitylink import protocol as constants

from ..model import Device
from .framed import PUBLISH_HEAD
from .latency import BITS_PER_BYTE, Latency, latencies, publishes_of

USUAL_BAUD_HZ = (115_200, 230_400, 460_800, 921_600, 1_000_000, 2_000_000, 3_000_000, 6_000_000, 12_000_000)


def message_bytes(letters: int, data_bytes: int, checked: bool = False) -> int:
    """Return the bytes of a message: head, letters, `:`, two digits for each byte, checksum, end of line.

    >>> message_bytes(len("PUB"), 2 + 4)  # %PUB:ggnn........
    18
    """
    return 1 + letters + 1 + 2 * data_bytes + (3 if checked else 0) + 1


def publish_bytes(words: int, data_bits: int, checked: bool = False, protocol: str = "classic") -> int:
    """Return the bytes of a publish of `words` words. Frames always have their check.

    >>> publish_bytes(8, 32), publish_bytes(8, 32, protocol="framed")
    (74, 45)
    """
    if protocol == "classic":  # its data begin with the group and the count
        return message_bytes(len(constants.REPLY_PUBLISH), 2 + words * data_bits // 8, checked)
    return PUBLISH_HEAD + words * (data_bits // 8) + constants.FRAMED_LATENCY_FRAME_BYTES


@dataclass(frozen=True)
class GroupBudget:
    """One subscription group. `rate_hz` is None if an event triggers it whose rate is unknown. The cycle of a
    ring has a rate, but no divisor.

    `sampled_s` limits the time from the tick (or event) to the read of the first word in the gateware.
    `latency_s` limits the time to the last byte on the line. It is None without a baud rate, or if the next
    publish may be due before this one is done.
    """

    number: int
    name: str
    divisor: int
    rate_hz: float | None
    words: int
    message_bytes: int
    paths: tuple[str, ...]
    sampled_s: float | None
    latency_s: float | None

    @property
    def bytes_per_s(self) -> float:
        return self.message_bytes * self.rate_hz if self.rate_hz else 0.0


@dataclass(frozen=True)
class BaudBudget:
    """One baud rate: the share of the line that the publishes use, and the highest rate that fits.

    `highest_hz` is a base rate / divisor at which every group with a rate could publish. It is None if not
    even the slowest rate fits.
    """

    baud_hz: int
    load: float
    highest_hz: float | None


@dataclass(frozen=True)
class DeviceBudget:
    """One device of a spec. `tick_bytes` are sent in a base tick if all groups with a rate are due."""

    root: str
    link: str
    data_bits: int
    base_hz: int
    protocol: str
    clock_hz: int
    baud_hz: int | None
    checked: bool
    groups: tuple[GroupBudget, ...]
    bauds: tuple[BaudBudget, ...]
    read_many: int

    @property
    def tick_bytes(self) -> int:
        return sum(group.message_bytes for group in self.groups if group.divisor)

    @property
    def bytes_per_s(self) -> float:
        return sum(group.bytes_per_s for group in self.groups)

    @property
    def load(self) -> float | None:
        """The share of the line at the link's baud rate. It is None without a baud rate."""
        return self.bytes_per_s * BITS_PER_BYTE / self.baud_hz if self.baud_hz else None

    @property
    def fits_2012(self) -> bool:
        """Whether the groups fit into the 2012 gateware without dividing any of them."""
        return len(self.groups) <= constants.GROUPS_2012 and all(
            group.words < constants.GROUP_SIZE_2012 for group in self.groups
        )


def budget(
    device: Device,
    *,
    protocol: str = "framed",
    clock_hz: int = constants.CLOCK_HZ_DEFAULT,
    baud_hz: int | None = None,
    checked: bool = False,
    read_many: int | None = None,
    timed: bool = True,
    engine: str | None = None,
) -> DeviceBudget:
    """Return the budget of a device, at the declared baud rate or at another one.

    `protocol` is the one of the link ("framed" or "classic"). `clock_hz` is the clock of the design, and
    `engine` its engine of the framed protocol ("fast" or "small"). None means the one of the link, or else
    the fast one. For the classic protocol, `checked` means that publishes have a checksum. Requests of
    `read_many` words may delay a publish that is due. Without `timed`, latencies are left out, because they
    take most of the time to compute.
    """
    link = device.link
    baud_hz = baud_hz if baud_hz is not None else link.baud_hz
    read_many = read_many if read_many is not None else constants.READ_MANY_MAX
    parts = [publishes_of(len(group.addresses), link.data_bits, protocol) for group in device.groups]
    costs = [sum(publish_bytes(n, link.data_bits, checked, protocol) for n in part) for part in parts]
    late = [Latency(None, None)] * len(costs)
    if timed and baud_hz:
        late = latencies(
            device, costs, baud_hz, read_many, protocol=protocol, clock_hz=clock_hz, engine=engine
        )
    groups = tuple(
        GroupBudget(
            number=group.number,
            name=group.name,
            divisor=group.divisor,
            rate_hz=link.base_hz / group.divisor if group.divisor else group.rate_hz,
            words=len(group.addresses),
            message_bytes=cost,
            paths=tuple(element.path for element in group.elements),
            sampled_s=one.sampled_s,
            latency_s=one.sent_s,
        )
        for group, cost, one in zip(device.groups, costs, late, strict=True)
    )
    bytes_per_s = sum(group.bytes_per_s for group in groups)
    together = sum(group.message_bytes for group in groups if group.divisor)
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
        protocol=protocol,
        clock_hz=clock_hz,
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
    slowest = (1 << 8 * constants.RATE_BYTES_MAX) - 1
    return base_hz / divisor if divisor <= slowest else None
