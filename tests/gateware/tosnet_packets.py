# SPDX-License-Identifier: BSD-3-Clause
"""The packets of TosNet's phases, as bytes with their check and before the scrambler.

A ring is a list of nodes in the order of the fibre: the first one's packets reach the second one first.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from gateware.tosnet_crc import checked, crc8

MASTER_DSC, MASTER_SET, NET_DSC, NET_SET, REG_DSC, REG_SET, DATA = 2, 3, 4, 5, 6, 7, 0xA
NODES_MOST = 15
REGISTER_BYTES = 16  # of a section, for each enabled register
SLOT_BYTES = 14  # the asynchronous block


@dataclass(frozen=True)
class Node:
    """A node of a ring. Bit r of `mask` enables register r."""

    id: int
    mask: int

    @property
    def registers(self) -> tuple[int, ...]:
        """Return the enabled registers in the order of the wire: from 7 down to 0."""
        return tuple(r for r in range(7, -1, -1) if self.mask >> r & 1)


@dataclass(frozen=True)
class Packet:
    """A packet from a line. `body` has the command, the payload and the check, and is not scrambled."""

    body: bytes
    seed: int = 0x55
    start: int = 0  # the sample with which its K28.5 begins
    end: int = 0  # the sample behind its last byte
    broken: str = ""  # why it ended before its time: a code or a disparity that does not exist

    @property
    def command(self) -> int:
        return self.body[0] >> 4 if self.body else 0

    @property
    def argument(self) -> int:
        return self.body[0] & 0xF if self.body else 0

    @property
    def payload(self) -> bytes:
        return self.body[1:-1]

    @property
    def good(self) -> bool:
        """Tell whether its check is right."""
        return not self.broken and len(self.body) >= 2 and crc8(self.body) == 0

    @property
    def poisoned(self) -> bool:
        """Tell whether its check is the inverted one: a node before has received it broken."""
        return not self.broken and len(self.body) >= 2 and crc8(self.body[:-1]) ^ 0xFF == self.body[-1]


@dataclass(frozen=True)
class Slot:
    """The asynchronous block of a DATA packet. `of_master`: the master asks; otherwise a node answers."""

    id: int
    data: bytes = b""
    valid: bool = False
    of_master: bool = True

    def block(self) -> bytes:
        """Return its bytes.

        >>> Slot(3, b"hi", valid=True).block().hex(), Slot(3, of_master=False).block().hex()
        ('9368690000000000000000000023', '2300000000000000000000000003')
        """
        kind = (9 if self.valid else 1) if self.of_master else (10 if self.valid else 2)
        count = len(self.data) if self.valid else 0
        return bytes([kind << 4 | self.id]) + self.data.ljust(12, b"\0") + bytes([count << 4 | self.id])

    @classmethod
    def of(cls, block: bytes) -> Slot:
        kind, count = block[0] >> 4, block[13] >> 4
        return cls(block[0] & 0xF, block[1 : 1 + count], kind in (9, 10), kind in (1, 9))


def from_master(ring: Sequence[Node]) -> list[Node]:
    """Return the ring from its master on, which is the node with the lowest id."""
    first = min(range(len(ring)), key=lambda place: ring[place].id)
    return [*ring[first:], *ring[:first]]


def master_dsc(lowest: int) -> bytes:
    """Phase 1: the lowest id that a node has seen, its own included."""
    return checked([MASTER_DSC << 4 | lowest])


def master_set(master: int) -> bytes:
    """Phase 1: who the master is, once round."""
    return checked([MASTER_SET << 4 | master])


def net_dsc(ring: Sequence[Node], place: int) -> bytes:
    """Phase 2: what the node at the ring address `place` sends: all nodes up to itself.

    >>> ring = [Node(1, 1), Node(7, 1), Node(3, 1)]
    >>> net_dsc(ring, 0)[:-1].hex(), net_dsc(ring, 2)[:-1].hex()
    ('4101', '43011723')
    """
    return checked([NET_DSC << 4 | place + 1, *_addresses(ring[: place + 1])])


def net_set(ring: Sequence[Node]) -> bytes:
    """Phase 2: all nodes, once round."""
    return checked([NET_SET << 4 | len(ring), *_addresses(ring)])


def reg_dsc(ring: Sequence[Node], place: int) -> bytes:
    """Phase 3: what the node at the ring address `place` sends: the masks of all nodes up to itself."""
    return checked([REG_DSC << 4, *_masks(ring[: place + 1])])


def reg_set(ring: Sequence[Node]) -> bytes:
    """Phase 3: the masks of all nodes, once round."""
    return checked([REG_SET << 4, *_masks(ring)])


def network_registers(ring: Sequence[Node]) -> list[int]:
    """Return what each node has stored when the phases are over.

    >>> [hex(word) for word in network_registers([Node(1, 1), Node(7, 0x83)])]
    ['0x10101', '0x838317']
    """
    return [node.mask << 16 | node.mask << 8 | at << 4 | node.id for at, node in enumerate(ring)]


def start_up(ring: Sequence[Node], place: int) -> list[bytes]:
    """Return what the node at `place` sends from the election's end to the first DATA packet.

    `ring` begins with the master. The packets MASTER_DSC before are as many as the resets are apart.
    """
    return [
        master_dsc(ring[0].id),
        master_set(ring[0].id),
        net_dsc(ring, place),
        net_set(ring),
        reg_dsc(ring, place),
        reg_set(ring),
    ]


def _addresses(nodes: Iterable[Node]) -> list[int]:
    return [at << 4 | node.id for at, node in enumerate(nodes)]


def _masks(nodes: Iterable[Node]) -> list[int]:
    return [mask for node in nodes for mask in (node.mask, node.mask)]


@dataclass
class Words:
    """Words of the shared memory by their address: id * 64 + register * 8 + 4 if IN + word. Others are 0."""

    words: dict[int, int] = field(default_factory=dict)

    def section(self, node: Node, *, of_in: bool) -> bytes:
        """Return the OUT or IN section of a node: registers from 7 down, words with the low byte first."""
        first = [node.id * 64 + r * 8 + 4 * of_in for r in node.registers]
        return b"".join(self.words.get(at + w, 0).to_bytes(4, "little") for at in first for w in range(4))

    def store(self, node: Node, section: bytes, *, of_in: bool) -> None:
        """Take over a section."""
        for index in range(len(section) // 4):
            at = node.id * 64 + node.registers[index // 4] * 8 + 4 * of_in + index % 4
            self.words[at] = int.from_bytes(section[4 * index : 4 * index + 4], "little")


def data_packet(ring: Sequence[Node], words: Words, slot: Slot) -> bytes:
    """Return what the master sends: its own OUT, the others' OUT of the last cycle, and all IN."""
    sections = (words.section(node, of_in=of_in) for node in ring for of_in in (False, True))
    return checked([DATA << 4, *b"".join(sections), *slot.block()])


def places(ring: Sequence[Node], place: int) -> tuple[slice, slice]:
    """Return where in a DATA packet the OUT and the IN section of a node are."""
    start = 1 + sum(2 * REGISTER_BYTES * len(node.registers) for node in ring[:place])
    size = REGISTER_BYTES * len(ring[place].registers)
    return slice(start, start + size), slice(start + size, start + 2 * size)


def through(
    ring: Sequence[Node], place: int, packet: bytes, own: Words, answer: Slot | None = None
) -> tuple[bytes, Words]:
    """Pass a DATA packet through the slave at `place`: what it sends, and its mirror of the others' words.

    It stores its IN and puts its OUT there. It answers in the slot only if it is addressed.
    """
    mirror = Words()
    for at, node in enumerate(ring):
        for of_in, section in enumerate(places(ring, at)):
            if at != place or of_in:
                mirror.store(node, packet[section], of_in=bool(of_in))
    sent = bytearray(packet)
    sent[places(ring, place)[1]] = own.section(ring[place], of_in=False)
    slot = Slot.of(packet[-1 - SLOT_BYTES : -1])
    if answer is not None and slot.of_master and slot.id == ring[place].id:
        sent[-1 - SLOT_BYTES : -1] = answer.block()
    good = crc8(packet) == 0
    sent[-1] = crc8(sent[:-1]) ^ (0 if good else 0xFF)
    return bytes(sent), mirror


def taken_by_master(ring: Sequence[Node], packet: bytes) -> tuple[Words, Slot]:
    """Return the slaves' OUT words as the master finds them in their IN sections, and the slot."""
    found = Words()
    for at, node in enumerate(ring[1:], start=1):
        found.store(node, packet[places(ring, at)[1]], of_in=False)
    return found, Slot.of(packet[-1 - SLOT_BYTES : -1])


def cycle(
    ring: Sequence[Node],
    master: Words,
    own: Sequence[Words],
    slot: Slot,
    answers: dict[int, Slot] | None = None,
) -> list[bytes]:
    """Return the packets of one cycle on each fibre, the master's own first.

    `own` has the OUT words of each slave. `answers` has what slaves by their place answer in the slot.
    """
    sent = [data_packet(ring, master, slot)]
    for place in range(1, len(ring)):
        sent.append(through(ring, place, sent[-1], own[place - 1], (answers or {}).get(place))[0])
    return sent
