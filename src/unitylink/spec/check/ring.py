# SPDX-License-Identifier: BSD-3-Clause
"""Check that a TosNet ring can carry what a spec asks for."""

from __future__ import annotations

import math
from collections.abc import Mapping

from unitylink import protocol

from ..expand.publishing import devices
from ..expand.resolve import Resolver
from ..isochrony.ring import RingBudget, ring_budget
from ..model import Device, Element, Instance, Link
from ..report.diagnostics import Reporter
from ..ring import Ring, RingNode, RingWord, rings_of
from ..text.syntax import LinkKindNode


def check_rings(resolver: Resolver, links: Mapping[str, Link], reporter: Reporter) -> None:
    """Report rings that cannot be, and publishes that a ring has no new values for."""
    if not any(one.element.link.kind == "tosnet" for one in resolver.placed):
        return
    for device in devices(tuple(resolver.roots), links):
        for root in (one for one in resolver.roots if one.name == device.root):
            _check_one_description(root, device, resolver, reporter)
            for ring in rings_of(root, device.comm):
                _Check(resolver, root, device, ring).run()


def _check_one_description(root: Instance, device: Device, resolver: Resolver, reporter: Reporter) -> None:
    """Two instances may give one ring. Then both must say the same about it."""
    first: dict[int, Element] = {}
    for element in root.walk():
        link = element.link
        if link.kind != "tosnet" or link.comm != device.comm:
            continue
        earlier = first.setdefault(link.base, element)
        if earlier.link.ring != link.ring:
            node = _statements(resolver, root, link.base)[-1]
            message = f"the ring at BASE {link.base} is described in two ways"
            hint = "give NODE, BAUD and the like once, or alike"
            reporter.report("UL108", node.start, node.end, message, hint)
            return


def _statements(resolver: Resolver, root: Instance, base: int) -> list[LinkKindNode]:
    """Return the TOSNETs of the text that give the ring at `base`, in their order."""
    given = {scope.node.name.text: scope.link_kind for scope in resolver.scopes.all if scope.link_kind}
    found: dict[str, LinkKindNode] = {}

    def below(instance: Instance) -> None:
        if instance.link.kind == "tosnet" and instance.link.base == base and instance.constructor in given:
            found.setdefault(instance.constructor, given[instance.constructor])
        for inner in instance.instances:
            below(inner)

    below(root)
    return list(found.values())


class _Check:
    def __init__(self, resolver: Resolver, root: Instance, device: Device, ring: Ring) -> None:
        self.resolver = resolver
        self.reporter = resolver.reporter
        self.root = root
        self.device = device
        self.ring = ring
        self.budget: RingBudget = ring_budget(ring)

    def run(self) -> None:
        self._check_options()
        self._check_ids()
        self._check_size()
        self._check_cycle()
        self._check_publishes()

    def _check_options(self) -> None:
        """What is beyond the published network needs nodes that were built for it."""
        options = self.ring.options
        given = {
            "RINGS": options.rings > 1,
            "CHECK_BYTES": options.check_bytes > 1,
            "TIME": options.time is not None,
        }
        for key in (key for key, used in given.items() if used and options.nodes != "ring"):
            message = f"{key} is of nodes behind a line, and here they are inside"
            self._at_property(key, message, f"add `NODES=ring`, or leave out {key}")
        if options.time is None:
            return
        word, own = RingWord.at(options.time), self.ring.own
        first = own.id << protocol.TOSNET_NODE_SHIFT
        if word.node != own.id or word.inward:
            message = f"TIME is 0x{options.time:X}, which is no OUT word of the PC's own node {own.id}"
            self._at_property(
                "TIME", message, f"write `TIME=0x{first:X}`, its first OUT word, or another one"
            )
            return
        taken = self.ring.base + options.time
        for element in (*own.gives, *own.obeys):
            if taken in element.addresses:
                message = f"`{element.path}` is at 0x{taken:X}, where the ring carries its clock (TIME)"
                self._at(element, "UL108", message, "move one of them to a free OUT word")

    def _check_ids(self) -> None:
        own = self.ring.own
        if own.id == 0 and self.ring.options.nodes == "ring":
            message = "the PC's own node is 0, and nodes on a line have the ids 1 to 15"
            hint = "write `NODE=1`, and move the values of node 1 to nodes 2 to 15"
            self._at(_one(self.ring.nodes[0] if self.ring.nodes else own), "UL108", message, hint)
            return
        if self.ring.options.node is not None:
            for element in (*own.obeys, *own.gives):
                if element.access != "WRITE" or element in own.obeys:
                    message = f"`{element.path}` is a value of node {own.id}, and that is the PC's own node"
                    hint = "no other node gives or obeys its words: move the value, or choose another NODE"
                    self._at(element, "UL108", message, hint)
                    break
        for node in self.ring.nodes:
            if node.id == 0:
                message = f"`{_one(node).path}` is a value of node 0"
                hint = "the id 0 addresses all nodes; ids of nodes are 1 to 15"
                self._at(_one(node), "UL107", message, hint)
            elif node.id < own.id:
                message = f"node {node.id} has a lower id than the PC's own node {own.id}"
                hint = "the node with the lowest id is the master of the ring, and that must be the PC's"
                self._at(_one(node), "UL107", f"{message}, and would be master", hint)
                break

    def _check_size(self) -> None:
        most = protocol.TOSNET_RING_NODES_MAX
        if self.ring.size > most:
            message = f"with the PC's own, the ring has {self.ring.size} nodes, and {most} is the most"
            hint = "leave out a node, or put some into a second ring with another BASE"
            self._at(_one(self.ring.nodes[-1]), "UL108", message, hint)

    def _check_cycle(self) -> None:
        wanted = self.ring.options.cycle_hz
        if wanted is None:
            return
        highest = int(1 / self.budget.shortest_s)
        if wanted > highest:
            message = f"the ring makes at most {highest:,} cycles a second, and CYCLE_RATE is {wanted:,} Hz"
            hint = (
                f"{self.ring.registers} registers of {self.ring.size} nodes take "
                f"{self.budget.shortest_s * 1e6:.1f} us at {self.budget.baud_hz:,} baud: "
                "use fewer registers, or raise BAUD"
            )
            self._at_property("CYCLE_RATE", message, hint)
        elif wanted * self.ring.watchdog_s < 1:
            message = f"at {wanted} Hz, each node would take the ring for broken"
            hint = (
                f"its watchdog waits {self.ring.watchdog_s * 1e3:.1f} ms: "
                f"choose {math.ceil(1 / self.ring.watchdog_s)} Hz or more"
            )
            self._at_property("CYCLE_RATE", message, hint)

    def _check_publishes(self) -> None:
        """A publish that is faster than the ring repeats values. Each rate is told once."""
        told: set[int] = set()
        for element in (e for node in (self.ring.own, *self.ring.nodes) for e in (*node.gives, *node.obeys)):
            publish = element.publish
            if publish is None or not publish.rate_hz or publish.divisor in told:
                continue
            if publish.rate_hz * self.budget.cycle_s > 1 + 1e-9:
                told.add(publish.divisor)
                cycles = f"{1 / self.budget.cycle_s:,.0f} cycles a second"
                message = (
                    f"`{element.path}` is published at {publish.rate_hz:g} Hz, and the ring makes {cycles}"
                )
                hint = "some publishes repeat a value: publish slower, or speed up the ring with BAUD"
                self._at(element, "UL109", message, hint)

    def _at(self, element: Element, code: str, message: str, hint: str) -> None:
        start = self.reporter.sources.offset(element.span)
        self.reporter.report(code, start, start + element.span.end - element.span.start, message, hint)

    def _at_property(self, key: str, message: str, hint: str) -> None:
        statements = _statements(self.resolver, self.root, self.ring.base)
        given = next(one for node in statements for one in node.properties if one.key == key)
        self.reporter.report("UL108", given.start, given.end, message, hint)


def _one(node: RingNode) -> Element:
    return (*node.gives, *node.obeys)[0]
