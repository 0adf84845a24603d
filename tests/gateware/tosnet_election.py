# SPDX-License-Identifier: BSD-3-Clause
"""How a TosNet ring starts, packet by packet: a model of `tosnet_start`, and all that a ring of them can do.

`received` is what one node does with one packet; `test_tosnet_election.py` compares it with the VHDL. `Ring`
puts nodes together. Packets travel as long as they like, nodes speak by themselves and are reset whenever
they like, and packets are damaged. So it has all orders that clocks, line lengths and faults can give.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from enum import IntEnum

MASTER_DSC, MASTER_SET, NET_DSC, NET_SET, REG_DSC, REG_SET = 2, 3, 4, 5, 6, 7


class Phase(IntEnum):
    """What a node of the ring is doing; as the bits 6 and 5 of the packets that belong to it."""

    RUNNING = 0
    ELECTING = 1
    COUNTING = 2
    REGISTERING = 3


@dataclass(frozen=True, slots=True)
class Packet:
    """The bytes of a packet without its check, and whether the check fits."""

    data: tuple[int, ...]
    good: bool = True


@dataclass(frozen=True, slots=True)
class Node:
    """One node. `members` are the ids of the last list."""

    id: int
    mask: int = 1
    may_be_master: bool = True
    most_nodes: int = 5
    phase: Phase = Phase.ELECTING
    master: bool = False
    claimed: bool = False
    own_address: int = 0
    nodes: int = 0
    members: frozenset[int] = frozenset()


def restarted(node: Node) -> Node:
    """Return the node as its election begins again."""
    return replace(node, phase=Phase.ELECTING, master=False, claimed=False)


def spoken(node: Node) -> Packet:
    """Return what an electing node says by itself."""
    return Packet(((MASTER_SET if node.claimed else MASTER_DSC) << 4 | node.id,))


def received(node: Node, packet: Packet, *, ghost: bool = False) -> tuple[Node, tuple[Packet, ...]]:
    """Return the node after a packet, and what it sends. `ghost`: a foreign id is dropped."""
    command, low = packet.data[0] >> 4, packet.data[0] & 0xF
    if command in {MASTER_DSC, MASTER_SET}:
        return _elected(node, packet, ghost=ghost) if packet.good else (node, ())
    if command >> 1 != node.phase or command < NET_DSC:
        return node, ()
    return _listed(node, packet, command, low)


def _elected(node: Node, packet: Packet, *, ghost: bool) -> tuple[Node, tuple[Packet, ...]]:
    is_set, low = packet.data[0] >> 4 == MASTER_SET, packet.data[0] & 0xF
    electing = node.phase is Phase.ELECTING
    own = Packet((MASTER_DSC << 4 | node.id,))
    after = node if is_set or electing else restarted(node)
    if low < node.id:
        after = replace(after, claimed=False)
        if is_set:
            return replace(after, master=False, phase=Phase.COUNTING), (packet,)
        return after, () if ghost else (packet,)
    if is_set:
        if low != node.id:
            return restarted(after), ()
        if electing and node.claimed and node.may_be_master:
            after = replace(after, master=True, own_address=0, phase=Phase.COUNTING)
            return after, (Packet((NET_DSC << 4 | 1, node.id)),)
        return after, ()
    if low != node.id or not electing:
        return after, (own,) if not node.claimed or not electing else ()
    if node.may_be_master and not node.claimed:
        return replace(after, claimed=True), (Packet((MASTER_SET << 4 | node.id,)),)
    return after, ()


def _listed(node: Node, packet: Packet, command: int, low: int) -> tuple[Node, tuple[Packet, ...]]:
    is_set, counting = bool(command & 1), node.phase is Phase.COUNTING
    payload = packet.data[1:]
    passes = not (is_set and node.master)
    flawed = False
    if command == NET_DSC:
        if not node.master and low >= node.most_nodes:
            passes, flawed = False, True
        node = replace(node, own_address=0 if node.master else low)
    present = False
    if command == NET_SET:
        flawed = low > node.most_nodes or low == 0
        members: frozenset[int] = frozenset()
        for place, entry in enumerate(payload):
            present = present or place == node.own_address
            mine = place == node.own_address and entry & 0xF != node.id
            flawed = flawed or entry >> 4 != place or mine or entry & 0xF in members
            members |= {entry & 0xF}
        node = replace(node, nodes=low, members=members)
    if command == REG_SET:
        flawed = any(a != b for a, b in zip(payload[::2], payload[1::2], strict=False))

    sent: tuple[Packet, ...] = ()
    if passes:
        first = packet.data[0]
        if node.master:
            first |= 0x10
        elif command == NET_DSC:
            first = first & 0xF0 | (low + 1 & 0xF)
        tail: tuple[int, ...] = ()
        if packet.good and not node.master and not is_set:
            tail = (node.own_address << 4 | node.id,) if counting else (node.mask, node.mask)
        sent = (Packet((first, *payload, *tail), packet.good),)
    if not packet.good:
        return node, sent
    count = len(payload) if counting else len(payload) // 2
    if flawed or (is_set and (count != node.nodes or (counting and not present))):
        return restarted(node), sent
    if is_set and counting:
        node = replace(node, phase=Phase.REGISTERING)
        return node, (*sent, Packet((REG_DSC << 4, node.mask, node.mask))) if node.master else sent
    if is_set:
        return replace(node, phase=Phase.RUNNING), sent
    return node, sent


@dataclass(frozen=True, slots=True)
class Ring:
    """Nodes in the order of the line, and the packets on the line behind each."""

    nodes: tuple[Node, ...]
    lines: tuple[tuple[Packet, ...], ...]

    @classmethod
    def of(cls, ids: tuple[int, ...]) -> Ring:
        """Return a ring in its reset."""
        return cls(tuple(Node(number) for number in ids), ((),) * len(ids))

    @property
    def complete(self) -> bool:
        """Tell whether all nodes run, and the one with the lowest id is their master."""
        ids = frozenset(node.id for node in self.nodes)
        return all(
            node.phase is Phase.RUNNING and node.master == (node.id == min(ids)) and node.members == ids
            for node in self.nodes
        )

    def _with(self, place: int, node: Node, line: tuple[Packet, ...]) -> Ring:
        nodes, lines = list(self.nodes), list(self.lines)
        nodes[place], lines[place] = node, line
        return Ring(tuple(nodes), tuple(lines))

    def steps(self, *, faults: bool) -> Iterator[Ring]:
        """Yield what the ring may become next; with faults, also by resets and damaged packets."""
        empty = not any(self.lines)
        for place, node in enumerate(self.nodes):
            before = place - 1
            ahead = self.lines[place]
            if self.lines[before]:
                packet, *rest = self.lines[before]
                left = self._with(before, self.nodes[before], tuple(rest))
                for ghost in (False, True):
                    after, sent = received(node, packet, ghost=ghost)
                    yield left._with(place, after, (*left.lines[place], *sent))
                if faults and packet.good:
                    after, sent = received(node, replace(packet, good=False))
                    yield left._with(place, after, (*left.lines[place], *sent))
            # Each node speaks every 16 hops, so there are not more packets than nodes when one speaks.
            if node.phase is Phase.ELECTING and sum(map(len, self.lines)) < len(self.nodes):
                yield self._with(place, node, (spoken(node),))
            # The watchdog is longer than any packet travels.
            if empty and not self.complete:
                yield self._with(place, restarted(node), ahead)
            if faults:
                yield self._with(place, Node(node.id), ahead)


def explored(
    start: Ring, *, faults: bool, bound: int, look: Callable[[Ring], None]
) -> tuple[set[Ring], set[Ring]]:
    """Return all rings that `start` may become, up to `bound`, and those that may never be complete.

    Raises what `look` raises for one of them.
    """
    before: dict[Ring, list[Ring]] = {start: []}
    todo = deque([start])
    while todo and len(before) < bound:
        ring = todo.popleft()
        look(ring)
        for following in ring.steps(faults=faults):
            if following not in before:
                before[following] = []
                todo.append(following)
            before[following].append(ring)
    fine = {ring for ring in before if ring.complete} | set(todo)
    back = deque(fine)
    while back:
        for ring in before[back.popleft()]:
            if ring not in fine:
                fine.add(ring)
                back.append(ring)
    return set(before), set(before) - fine
