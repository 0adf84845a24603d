# SPDX-License-Identifier: BSD-3-Clause
"""Components in the nodes of a ring: which of their words travel, and in which node each is."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from unitylink import protocol

from ..model import Carried, Component, Element, Group, Instance, LinkBinding, Member
from ..report.diagnostics import Reporter
from ..ring import RingWord
from ..text.syntax import ExpansionNode, Name, Number
from .vectors import Vector

_NODE_BUS = "node"  # the kind of link of a word that does not travel, until the expansion is complete
_KEPT = ("READ", "WRITE", "READWRITE")  # a word of another access is an act, and a ring repeats its words


def lies_in_node(link: LinkBinding) -> bool:
    """Are components behind this link parts of nodes of their own?"""
    return link.kind == "tosnet" and link.ring.nodes == "ring"


def report_if_hidden(element: Element, name: Name, reporter: Reporter) -> None:
    """Report a group that lists a word of a node's component by its name, and this word does not travel."""
    if element.link.kind == _NODE_BUS:
        message = f"`{element.path}` does not travel in the ring, so the PC has no such value"
        hint = f"bind it to a word of its node, `@{name.text}=…`, or leave it out of the group"
        reporter.report("UL110", name.start, name.end, message, hint)


@dataclass
class NodePart:
    """A component in a node, while its constructor is expanded. `bound` has its words that travel."""

    words: int
    link: LinkBinding
    bound: Mapping[str, Vector]
    reporter: Reporter
    carried: list[Carried] = field(default_factory=list)
    constants: list[Element] = field(default_factory=list)
    seen: dict[str, int] = field(default_factory=dict)  # element or array -> how many there are

    def take(self, element: Element, number: Number) -> tuple[Element, Number | None]:
        """Return the element as the PC sees it, and the place of its address in the text.

        If it does not travel, there is no place, and nobody but a wire sees it.
        """
        name, offset = element.array or element.name, element.address - self.link.base
        self.seen[name] = self.seen.get(name, 0) + 1
        vector = self.bound.get(name)
        if vector is None or (element.index or 0) >= len(vector.numbers):
            hidden = replace(element, address=offset, link=replace(self.link, kind=_NODE_BUS), publish=None)
            if element.access in _KEPT[1:] and (element.initial is not None or element.safe is not None):
                self.constants.append(hidden)
            return hidden, None
        number = vector.numbers[element.index or 0]
        assert isinstance(number.value, int)  # an address was made from it
        self._check_place(element, number.value, number)
        inward = RingWord.at(number.value).inward
        able = element.writable if inward else element.readable
        if element.access not in _KEPT or not able:
            which = "an IN word, which the PC writes" if inward else "an OUT word, which the node writes"
            message = f"`{element.path}` is a {element.access}, and 0x{number.value:X} is {which}"
            hint = (
                "a READ travels in an OUT word, a WRITE in an IN word, and acts such as PULSE do not travel"
            )
            self.reporter.report("UL110", number.start, number.end, message, hint)
        seen = replace(element, address=self.link.base + number.value)
        if inward:
            seen = replace(seen, access="WRITE", publish=None)
        else:
            seen = replace(seen, access="READ", initial=None, safe=None)
        self.carried += [
            Carried(offset + word, address, inward) for word, address in enumerate(seen.addresses)
        ]
        return seen, number

    def _check_place(self, element: Element, offset: int, number: Number) -> None:
        """Report words that are not those of one node, or not all OUT words or IN words of one register."""
        words = {RingWord.at(offset + word) for word in range(element.words)}
        node = offset >> protocol.TOSNET_NODE_SHIFT
        if len(words) == 1 and 0 < node <= protocol.TOSNET_RING_NODES_MAX:
            return
        if len(words) > 1:
            message = f"`{element.path}` has {element.words} words, and from 0x{offset:X} on there is no room"
        else:
            message = f"`{element.path}` is bound to 0x{offset:X}, which is no word of a joint's node"
        hint = "a register has 4 OUT words and 4 IN words, and the nodes 1 to 15 have 64 addresses each"
        self.reporter.report("UL110", number.start, number.end, message, hint)

    def finished(self, component: Component) -> Component:
        """Return the component, with its words. All its elements have been taken."""
        for name, vector in self.bound.items():
            there = self.seen.get(name, 0)
            if there != len(vector.numbers):
                message = f"`{name}` is bound to {len(vector.numbers)} addresses, and there are {there} of it"
                hint = "give the first address of each, or look at the component's page for what it needs"
                self.reporter.report("UL110", vector.start, vector.end, message, hint)
        found = tuple(self.carried), tuple(self.constants)
        return replace(component, words=self.words, carried=found[0], constants=found[1])


def bound_rightly(
    link: LinkBinding, block: str, vectors: Mapping[str, Vector], node: ExpansionNode, reporter: Reporter
) -> bool:
    """Are the words of a component bound by their names in a node, and only there?"""
    inside = lies_in_node(link)
    wrong = next((vector for name, vector in vectors.items() if (name == block) == inside), None)
    if wrong is None:
        return True
    if inside:
        message = f"`{node.name.text}` is in a node of a ring, where the PC does not reach its registers"
        hint = "bind the words that travel, by their names: `@position=0x80`"
    else:
        message = f"`{node.name.text}` is in no node of a ring, and all its words are on the bus"
        hint = "give its first address, or none; only behind `TOSNET(…, NODES=ring)` its words are bound"
    reporter.report("UL110", wrong.start, wrong.end, message, hint)
    return False


def first_word(node: ExpansionNode) -> Vector:
    """Return what the block of a component is bound to: its addresses count from 0."""
    at = node.callee.start, node.callee.end
    return Vector([Number(0, *at)], *at, node.name.start)


class NodeParts:
    """Finds the node of each component of a ring, and its place on the bus of this node."""

    def __init__(self, reporter: Reporter) -> None:
        self.reporter = reporter
        self._nodes: dict[str, int] = {}  # path -> node
        self._next: dict[int, int] = {}  # node -> the first free address of its bus

    def settle(self, roots: Sequence[Instance]) -> list[Instance]:
        """Return the public constructors with only the words that the PC reaches."""
        settled = []
        for root in roots:
            self._nodes.clear()
            self._next.clear()
            made = self._settled(root, None) if any(_parts(root)) else root
            self._check_wires(made)
            settled.append(made)
        return settled

    def _settled(self, instance: Instance, node: int | None) -> Instance:
        own = [one for one in instance.instances if one.component and lies_in_node(one.link)]
        found = self._node_of(own) if own else None
        members: list[Member] = []
        for member in instance.members:
            if isinstance(member, Instance):
                members.append(self._settled(member, found if member in own else None))
            elif isinstance(member, Group):
                elements = tuple(one for one in member.elements if one.link.kind != _NODE_BUS)
                if elements or not member.elements:
                    members.append(replace(member, elements=elements))
            elif member.link.kind != _NODE_BUS:
                members.append(member)
        component = instance.component
        if component is not None and node is not None:
            size = 1 << max(0, component.words - 1).bit_length()
            base = -(-self._next.get(node, 0) // size) * size
            self._next[node] = base + size
            self._nodes[instance.path] = node
            component = replace(component, node=node, base=base)
        return replace(instance, members=tuple(members), component=component)

    def _node_of(self, parts: Sequence[Instance]) -> int | None:
        """Return the node of the components that one constructor expands. They wire to each other."""
        first: tuple[int, Instance] | None = None
        for part in parts:
            assert part.component is not None  # the caller has checked it
            for word in part.component.carried:
                node = (word.address - part.link.base) >> protocol.TOSNET_NODE_SHIFT
                if first is None:
                    first = node, part
                elif first[0] != node:
                    message = f"`{part.path}` has a word in node {node}, and `{first[1].path}` in {first[0]}"
                    hint = "the components that one constructor expands are in one node: divide it"
                    self._at(part, message, hint)
                    return None
        if first is None and not self.reporter.failed:
            message = f"no word of `{parts[0].path}` travels, so it is in no node"
            hint = "bind a word of it, or of a component beside it: `@position=0x80`"
            self._at(parts[0], message, hint)
        return first[0] if first else None

    def _check_wires(self, root: Instance) -> None:
        for part in _parts(root):
            for _, _, other, _ in part.component.connections if part.component else ():
                own, its = self._nodes.get(part.path), self._nodes.get(other)
                if own != its:
                    message = f"`{part.path}` has a wire to `{other}`, and they are in different FPGAs"
                    hint = "a wire leads from a component to another one of the same node"
                    self._at(part, message, hint)

    def _at(self, part: Instance, message: str, hint: str) -> None:
        start = self.reporter.sources.offset(part.span)
        self.reporter.report("UL110", start, start + part.span.end - part.span.start, message, hint)


def _parts(instance: Instance) -> Iterator[Instance]:
    for inner in instance.instances:
        if inner.component is not None:
            yield inner
        yield from _parts(inner)
