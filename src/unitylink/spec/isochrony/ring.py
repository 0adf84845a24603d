# SPDX-License-Identifier: BSD-3-Clause
"""What a TosNet ring costs: bytes and time of a cycle, and how old a value is when the PC gets it."""

from __future__ import annotations

from dataclasses import dataclass

from unitylink import protocol

from ..model import Device, Instance
from ..ring import Ring, RingNode, rings_of
from .budget import DeviceBudget
from .latency import BITS_PER_BYTE


@dataclass(frozen=True)
class Span:
    """A time: usual, and at most. None: no bound is known."""

    typical_s: float | None
    bound_s: float | None


@dataclass(frozen=True)
class RingShare:
    """A node's share of a cycle. It writes the values of `gives`, and the PC those of `obeys`."""

    id: int
    registers: tuple[int, ...]
    cycle_bytes: int
    gives: tuple[str, ...]
    obeys: tuple[str, ...]


@dataclass(frozen=True)
class RingPublish:
    """A group with values of the ring. `sensor` is the time from a node's sensor to the last byte at the PC.

    It is without bound as long as the line has no baud rate, or if the next publish may be due before.
    """

    name: str
    paths: tuple[str, ...]
    sensor: Span


@dataclass(frozen=True)
class RingBudget:
    """A ring of a device. Times are in seconds. The first node is the PC's own.

    `shortest_s` is the shortest cycle, and `cycle_s` the one that the spec asks for. `inward` is the time
    from a node's sensor to the PC's node, and `outward` that from a commit to the outputs of the nodes.
    `rings`, `check_bytes` and `time` are those of `RingOptions`.
    """

    base: int
    nodes: tuple[RingShare, ...]
    baud_hz: int
    cycle_bytes: int
    hop_s: float
    shortest_s: float
    cycle_s: float
    inward: Span
    outward: Span
    rings: int = 1
    check_bytes: int = 1
    time: int | None = None
    publishes: tuple[RingPublish, ...] = ()


def ring_budget(ring: Ring) -> RingBudget:
    """Return the budget of a ring without its publishes.

    >>> from unitylink.spec import compile_text
    >>> text = "public a() { TOSNET(BASE=0); @x = 0x80: READ(); @y = 0x84: WRITE(); }"
    >>> one = ring_budget(rings_of(compile_text(text, "a.ul").spec.roots[0], None)[0])
    >>> one.cycle_bytes, f"{one.cycle_s * 1e6:.1f} us"
    (50, '52.0 us')
    """
    cycle_s = ring.cycle_s
    # A value waits for the end of a cycle, at most a whole one. The next cycle carries it.
    way = Span(1.5 * cycle_s, 2 * cycle_s)
    return RingBudget(
        base=ring.base,
        nodes=tuple(_share(node) for node in (ring.own, *ring.nodes)),
        baud_hz=ring.baud_hz,
        cycle_bytes=ring.cycle_bytes,
        hop_s=ring.hop_s,
        shortest_s=ring.shortest_s,
        cycle_s=cycle_s,
        inward=way,
        outward=way,
        rings=ring.options.rings,
        check_bytes=ring.options.check_bytes,
        time=ring.options.time,
    )


def _share(node: RingNode) -> RingShare:
    gives, obeys = (tuple(element.path for element in values) for values in (node.gives, node.obeys))
    size = protocol.TOSNET_RING_REGISTER_BYTES * len(node.numbers)
    return RingShare(node.id, node.numbers, size, gives, obeys)


def ring_budgets(root: Instance, device: Device, line: DeviceBudget) -> list[RingBudget]:
    """Return the rings of a device, with the publishes that `line` has the times of."""
    return [_with_publishes(ring, device, line) for ring in rings_of(root, device.comm)]


def _with_publishes(ring: Ring, device: Device, line: DeviceBudget) -> RingBudget:
    one = ring_budget(ring)
    bound = one.inward.bound_s
    usual = one.inward.typical_s
    assert bound is not None and usual is not None  # those of a ring are always known
    found = []
    for group, cost in zip(device.groups, line.groups, strict=True):
        values = [e for e in group.elements if e.link.kind == "tosnet" and e.link.base == ring.base]
        if not values:
            continue
        period_s = group.divisor / device.link.base_hz  # an event follows at once
        sent_s = cost.message_bytes * BITS_PER_BYTE / line.baud_hz if line.baud_hz else None
        sensor = Span(
            None if sent_s is None else usual + period_s / 2 + sent_s,
            None if cost.latency_s is None else bound + period_s + cost.latency_s,
        )
        found.append(RingPublish(group.name, tuple(element.path for element in values), sensor))
    return RingBudget(**{**vars(one), "publishes": tuple(found)})
