# SPDX-License-Identifier: BSD-3-Clause
"""The ring that a spec needs behind a TOSNET: its nodes, their registers, and who writes which value."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field

from unitylink import protocol

from .model import Element, Instance, RingOptions, Spec

_USUAL = (1, 0, *range(2, 16))  # ids for the PC's own node: the lowest id of a ring is its master


@dataclass(frozen=True)
class RingWord:
    """Where a word of the shared memory belongs. Who writes an `inward` word is the PC."""

    node: int
    register: int
    inward: bool

    @classmethod
    def at(cls, offset: int) -> RingWord:
        """Return the place of a word of the shared memory.

        >>> RingWord.at(0x8C)
        RingWord(node=2, register=1, inward=True)
        """
        return cls(
            offset >> protocol.TOSNET_NODE_SHIFT,
            offset >> protocol.TOSNET_REGISTER_SHIFT & 7,
            bool(offset >> protocol.TOSNET_IN_BIT & 1),
        )


@dataclass
class RingNode:
    """A node of a ring. Bit r of `registers` enables register r.

    The node writes the values of `gives`, and the PC those of `obeys`.
    """

    id: int
    registers: int = 0
    gives: list[Element] = field(default_factory=list)
    obeys: list[Element] = field(default_factory=list)

    @property
    def numbers(self) -> tuple[int, ...]:
        """The enabled registers.

        >>> RingNode(2, 0b101).numbers
        (0, 2)
        """
        return tuple(number for number in range(8) if self.registers >> number & 1)


@dataclass(frozen=True)
class Ring:
    """A ring as a spec needs it. `own` is the PC's node. `nodes` are the others, by their ids."""

    base: int
    own: RingNode
    nodes: tuple[RingNode, ...]
    options: RingOptions

    @property
    def size(self) -> int:
        return 1 + len(self.nodes)

    @property
    def registers(self) -> int:
        """The enabled registers of all nodes."""
        return sum(len(node.numbers) for node in (self.own, *self.nodes))

    @property
    def baud_hz(self) -> int:
        return self.options.baud_hz or protocol.TOSNET_RING_BAUD_HZ

    @property
    def cycle_bytes(self) -> int:
        """The bytes of a cycle's packet on the line."""
        rest = protocol.TOSNET_RING_REST_BYTES + self.options.check_bytes - 1
        return rest + protocol.TOSNET_RING_REGISTER_BYTES * self.registers

    @property
    def hop_s(self) -> float:
        """The time that a node adds to the way of a bit."""
        return protocol.TOSNET_RING_HOP_BITS / self.baud_hz

    @property
    def watchdog_s(self) -> float:
        """The time without a good packet after which a node takes the ring for broken. It counts bits."""
        return protocol.TOSNET_RING_WATCHDOG_US * 1e-6 * protocol.TOSNET_RING_BAUD_HZ / self.baud_hz

    @property
    def shortest_s(self) -> float:
        """The shortest cycle."""
        return self.cycle_bytes * protocol.TOSNET_RING_BYTE_BITS / self.baud_hz + self.hop_s * self.size

    @property
    def cycle_s(self) -> float:
        """The cycle that the spec asks for."""
        return 1 / self.options.cycle_hz if self.options.cycle_hz else self.shortest_s


def rings_of(root: Instance, comm: str | None) -> list[Ring]:
    """Return the rings that `root` reaches through `comm`, by their base addresses."""
    found: dict[int, list[Element]] = {}
    for element in root.walk():
        if element.link.kind == "tosnet" and element.link.comm == comm:
            found.setdefault(element.link.base, []).append(element)
    return [ring_of(elements) for _, elements in sorted(found.items())]


def ring_at(spec: Spec, base: int) -> Ring:
    """Return the ring that `spec` has at `base`, whatever the public constructors that reach it."""
    values = (element for _, element in spec.walk())
    return ring_of(one for one in values if one.link.kind == "tosnet" and one.link.base == base)


def ring_of(elements: Iterable[Element]) -> Ring:
    """Return the ring of the values behind one TOSNET. There is at least one.

    The PC's node is the one that the TOSNET states, or one whose OUT words the PC writes, or the lowest id
    that is free.
    """
    nodes: dict[int, RingNode] = {}
    bound = list(elements)
    base, options = bound[0].link.base, bound[0].link.ring
    own = options.node
    for element in bound:
        for address in element.addresses:
            if not 0 <= address - base < protocol.TOSNET_MEMORY_WORDS:
                continue
            word = RingWord.at(address - base)
            node = nodes.setdefault(word.node, RingNode(word.node))
            node.registers |= 1 << word.register
            values = node.obeys if word.inward else node.gives
            if not values or values[-1] is not element:
                values.append(element)
    if own is None:
        writes = [n.id for n in nodes.values() if any(element.access == "WRITE" for element in n.gives)]
        own = min(writes) if writes else next((one for one in _USUAL if one not in nodes), 0)
    if options.time is not None and (word := RingWord.at(options.time)).node == own:
        nodes.setdefault(own, RingNode(own)).registers |= 1 << word.register
    others = [nodes[number] for number in sorted(nodes) if number != own]
    return Ring(base, nodes.get(own, RingNode(own)), tuple(others), options)
