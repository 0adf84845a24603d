# SPDX-License-Identifier: BSD-3-Clause
"""Macro expansion: from the syntax tree to the model."""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import AbstractContextManager, nullcontext
from dataclasses import dataclass, field, replace

from ..annotation import Annotation
from ..meaning.declared import Declared
from ..meaning.elements import ElementReader
from ..meaning.evaluate import Value
from ..meaning.graph import MAX_ITEMS, Graph, cost_of_element, cost_of_expansion
from ..meaning.members import check_members
from ..meaning.notes import annotations_of, component, is_there
from ..meaning.scope import ADDRESS_MAX, INDEX, Scope, Scopes
from ..meaning.type_names import names_of
from ..model import Component, Element, Instance, Link, LinkBinding, Member, Span
from ..text.syntax import ElementNode, ExpansionNode, GroupNode, Name, Number, Program
from .allocate import Block, allocate, windows
from .group_members import Found, GroupMaker
from .link_kinds import bind_link
from .node_parts import NodePart, NodeParts, bound_rightly, first_word, lies_in_node
from .parameters import Parameters
from .publics import may_expand, report_no_public, report_too_many
from .vectors import Vector, Vectors


@dataclass(frozen=True)
class Placed:
    """An element with the place of its address in the text, for checks of addresses."""

    root: str
    element: Element
    address: Number
    statement: int  # start of the member that gave the address


@dataclass
class _Frame:
    """One expansion that is being made."""

    scope: Scope
    path: str
    names: dict[str, Value]
    vectors: dict[str, Vector]
    link: LinkBinding
    block: Block | None = None
    component: Component | None = None
    part: NodePart | None = None  # a component in a node of a ring
    found: Found = field(default_factory=dict)


class _TooMany(Exception):
    """The expansion is too large. A diagnostic has been given."""


class Resolver:
    """Expands the public constructors of a program.

    `roots` are instances, and `placed` has all their elements.
    """

    def __init__(
        self, program: Program, declared: Declared, links: Mapping[str, Link], scopes: Scopes
    ) -> None:
        self.reporter = scopes.reporter
        self.scopes = scopes
        self.declared = declared
        self.links = links
        self.evaluator = declared.evaluator
        self.roots: list[Instance] = []
        self.placed: list[Placed] = []
        self.blocks: list[Block] = []
        self.events: dict[str, tuple[str, Element]] = {}  # event of a component -> an element that names it
        self._elements = ElementReader(declared)
        self._parameters = Parameters(self.evaluator)
        self._vectors = Vectors(scopes, self.evaluator)
        self._groups = GroupMaker(self.evaluator)
        check_members(scopes, self._elements, links[""])
        self._graph = Graph(scopes, self.reporter)
        self._root = ""
        self._items = 0
        self._spans: dict[int, Span] = {}
        self._allocated: dict[tuple[str, str], int] = {}
        publics = [scope for scope in scopes.all if scope.node.public]
        if not publics and not program.damaged and not any(s.node.broken for s in scopes.all):
            report_no_public(program, self.reporter)
        ready = [scope for scope in publics if self._may_expand(scope)]
        self._expand_roots(ready)
        if any(block.first is None for block in self.blocks) and not self.reporter.failed:
            taken = [
                ((p.root, p.element.link.comm), p.element.address, p.element.words) for p in self.placed
            ] + windows((p.root, p.element.link) for p in self.placed)
            self._allocated = allocate(self.blocks, taken, self.reporter)
            self._expand_roots(ready)  # again, because now every address is known
        self.roots = NodeParts(self.reporter).settle(self.roots)
        self._vectors.report_lengths()

    # --- roots ----------------------------------------------------------------------------------------------

    def _may_expand(self, scope: Scope) -> bool:
        at = scope.node.name
        if scope.node.broken or self.scopes.first.get(at.text) is not scope:
            return False
        size = self._graph.sizes[at.text]
        self._items += size.items
        return may_expand(scope, size, self._items, self.reporter)

    def _expand_roots(self, scopes: list[Scope]) -> None:
        self.roots.clear()
        self.placed.clear()
        self.blocks.clear()
        self.events.clear()
        self._parameters.wires.clear()
        self._items = 0
        for scope in scopes:
            self._groups.clear()
            try:
                self._expand_root(scope)
            except _TooMany:
                report_too_many(scope.node.name, f"more than {MAX_ITEMS:,}", self.reporter)
                self.placed.clear()  # an incomplete expansion shows nothing
                self.blocks.clear()
                return

    def _expand_root(self, scope: Scope) -> None:
        name = scope.node.name
        self._root = name.text
        runtime = tuple(p.text for p in scope.node.parameters if p.text in scope.runtime)
        values = self._parameters.of_public(scope)
        frame = _Frame(scope, "", values, {}, LinkBinding("memory"))
        root = self._expand(frame, name.text, name.text, self._span(name))
        self.roots.append(replace(root, parameters=runtime) if runtime else root)

    def _spend(self, items: int) -> None:
        """Count what is made, because the size of an array may depend on parameters."""
        self._items += items
        if self._items > MAX_ITEMS:
            raise _TooMany

    # --- expansion ------------------------------------------------------------------------------------------

    def _expand(self, frame: _Frame, name: str, display: str, span: Span) -> Instance:
        scope = frame.scope
        if scope.link_kind is not None:
            frame.link = bind_link(scope, frame.link, frame.names, self.evaluator)
        documentation = scope.node.notes.documentation
        notes: tuple[Annotation, ...] = ()
        if scope.node.notes.annotations:
            notes = annotations_of(scope.node.notes, self.evaluator, frame.names)
            self._make_component(frame)
        found = frame.found
        groups: list[GroupNode] = []
        for node in scope.usable.values():
            if isinstance(node, ElementNode):
                found[node.name.text] = self._element_or_array(frame, node)
            elif isinstance(node, ExpansionNode):
                with self._component_use(node):
                    found[node.name.text] = self._instance_or_array(frame, node)
            else:
                groups.append(node)
        self._groups.members[frame.path] = found
        if groups:
            self._groups.add(groups, frame.path, frame.names)
            for group in groups:
                self._spend(
                    sum(
                        len(one.elements)
                        for one in found[group.name.text]
                        if not isinstance(one, (Element, Instance))
                    )
                )
        members = tuple(member for text in scope.usable for member in found.get(text, ()))
        if frame.part is not None and frame.component is not None:
            frame.component = frame.part.finished(frame.component)
        return Instance(
            name,
            frame.path,
            scope.node.name.text,
            display,
            frame.link,
            members,
            (),
            span,
            documentation,
            notes,
            frame.component,
        )

    def _make_component(self, frame: _Frame) -> None:
        node, block = frame.scope.node, frame.block
        made = component(node.notes, self.evaluator, frame.names, 0, 1)
        if made is None:
            return
        at = node.name
        if node.block is None:
            message = f"`{at.text}` is an entity, but has no number of words"
            hint = f"give it a block of addresses: `{at.text}(…): @base[4] {{ … }}`"
            self.reporter.report("UL098", at.start, at.end, message, hint)
        elif frame.part is not None:
            frame.component = made
        elif block is not None and frame.link.kind != "memory":
            message = f"a component of the gateware lies on its bus, not behind {frame.link.kind.upper()}"
            hint = "put it into a constructor with `MEMORY();`"
            if frame.link.kind == "tosnet":
                hint += ", or into a node: `TOSNET(…, NODES=ring);`"
            self.reporter.report("UL058", block.start, block.end, message, hint)
        elif block is not None and block.first is not None:
            frame.component = replace(made, base=block.first, words=block.words)

    def _component_use(self, node: ExpansionNode) -> AbstractContextManager[None]:
        """Let diagnostics inside a component of the library point to the place that uses it."""
        callee = self.scopes.first[node.callee.text].node
        if self.reporter.sources.in_library(callee.name.start):
            return self.reporter.using(node.callee.start, node.callee.end)
        return nullcontext()

    def _instance_or_array(self, frame: _Frame, node: ExpansionNode) -> list[Member]:
        if node.count is None:
            one = self._instance(frame, node, frame.names, node.name.text, None)
            return [] if one is None else [one]
        count = self._count(frame, node)
        made: list[Member] = []
        for index in range(count):
            names = {**frame.names, INDEX: index}
            one = self._instance(frame, node, names, f"{node.name.text}[{index}]", index)
            if one is not None:
                made.append(one)
        return made

    def _count(self, frame: _Frame, node: ElementNode | ExpansionNode) -> int:
        assert node.count is not None  # the caller has checked it
        return self.evaluator.integer(node.count, frame.names, "the size of an array", 1, MAX_ITEMS) or 0

    def _instance(
        self, frame: _Frame, node: ExpansionNode, names: dict[str, Value], name: str, index: int | None
    ) -> Instance | None:
        self._spend(1 + cost_of_expansion(node))
        callee = self.scopes.first[node.callee.text]
        path = f"{frame.path}.{name}" if frame.path else name
        values = self._parameters.given(node, callee, names, frame.found)
        if values is None:
            return None
        vectors = self._vectors.bound(node, callee, frame.vectors, names)
        if vectors is None:
            return None
        display = next((value for value in values.values() if isinstance(value, str) and value), path)
        inner = _Frame(callee, path, values, vectors, frame.link)
        if callee.node.block is not None:
            self._place_block(inner, node)
        for text, user in callee.computed.items():
            vector = vectors.get(text)
            if vector is None:
                continue
            if len(vector.numbers) == 1:
                address = vector.numbers[0].value
                assert isinstance(address, int)  # an address was made from it
                values[text] = address
            else:
                self._vectors.note_length((callee.node.name.text, text), vector, False, user)
        made = self._expand(inner, name, display, self._span(node.name))
        self._parameters.wires.drives(made, self._root, node.callee.start, node.callee.end)
        notes = node.notes
        if index is None and not notes.documentation and not notes.annotations:
            return made
        further = annotations_of(notes, self.evaluator, names) if notes.annotations else ()
        return replace(
            made,
            documentation=notes.documentation or made.documentation,
            annotations=(*made.annotations, *further),
            array="" if index is None else node.name.text,
            index=index,
        )

    def _place_block(self, frame: _Frame, node: ExpansionNode) -> None:
        """Note the block of an instance. An unbound block goes where there is room."""
        head = frame.scope.node
        assert head.block is not None  # the caller has checked it
        what = f"the number of words of `{head.name.text}`"
        words = self.evaluator.integer(head.block, frame.names, what, 1, 1 << 20)
        if words is None:
            frame.vectors.clear()
            return
        name = head.addresses[0].text
        is_component = any(one.name.text == "component" for one in head.notes.annotations)
        bound = dict(frame.vectors)
        if is_component and not bound_rightly(frame.link, name, bound, node, self.reporter):
            frame.vectors.clear()
            self._parameters.wires.unplaced = True
            return
        if is_component and lies_in_node(frame.link):
            frame.part = NodePart(words, frame.link, bound, self.reporter)
            frame.vectors.clear()
            frame.vectors[name] = first_word(node)
            return
        vector = frame.vectors.get(name)
        first: int | None = None
        kind, base = frame.link.kind, frame.link.base
        place = vector or node.callee
        if vector is not None and isinstance(vector.numbers[0].value, int):
            first = base + vector.numbers[0].value
        elif (self._root, frame.path) in self._allocated:
            first = self._allocated[self._root, frame.path]
            number = Number(first - base, node.callee.start, node.callee.end)
            frame.vectors[name] = Vector([number], number.start, number.end, node.name.start)
        else:
            self._parameters.wires.unplaced = True
        bits = self._link_of(frame.link).address_bits or 32
        limit = 1 << bits if kind == "memory" else 0
        frame.block = Block(
            self._root,
            frame.link.comm,
            frame.path,
            first,
            words,
            base,
            limit,
            place.start,
            place.end,
            is_component,
        )
        self.blocks.append(frame.block)

    def _link_of(self, binding: LinkBinding) -> Link:
        return self.links[binding.link if binding.link in self.links else ""]

    # --- elements -------------------------------------------------------------------------------------------

    def _element_or_array(self, frame: _Frame, node: ElementNode) -> list[Member]:
        if node.notes.annotations and not is_there(node.notes, self.evaluator, frame.names):
            return []
        if node.count is None:
            one = self._element(frame, node, frame.names, node.name.text)
            return [] if one is None else [one]
        count = self._count(frame, node)
        made: list[Member] = []
        for index in range(count):
            names = {**frame.names, INDEX: index}
            one = self._element(frame, node, names, f"{node.name.text}[{index}]", index)
            if one is not None:
                made.append(one)
        return made

    def _element(
        self,
        frame: _Frame,
        node: ElementNode,
        names: Mapping[str, Value],
        name: str,
        index: int | None = None,
    ) -> Element | None:
        self._spend(1 + cost_of_element(node))
        number: Number | None
        if node.fixed is not None:
            number, statement = self._vectors.address(node.fixed, names), node.name.start
        else:
            vector = frame.vectors.get(node.name.text)
            if vector is None:  # it belongs to a block for which room is still to be found
                return None
            fits = len(vector.numbers) == 1
            key = (frame.scope.node.name.text, node.name.text)
            self._vectors.note_length(key, vector, fits, node.name)
            number, statement = (vector.numbers[0] if fits else None), vector.statement
        if number is None:
            return None
        assert isinstance(number.value, int)  # an address was made from it
        path = f"{frame.path}.{name}" if frame.path else name
        display = self._display(node, names, path)
        known = self._elements.read(node, names, self._link_of(frame.link))
        if known is None or display is None:
            return None
        address = frame.link.base + number.value
        if index and not (node.fixed is not None and any(one.text == INDEX for one in names_of(node.fixed))):
            # an array has consecutive words, unless its address uses the index
            address += index * known.words
        if address + known.words - 1 > ADDRESS_MAX:
            message = f"with BASE 0x{frame.link.base:X} this address is 0x{address:X}, beyond 32 bits"
            hint = f"the largest is 0x{ADDRESS_MAX:X}"
            self.reporter.report("UL050", number.start, number.end, message, hint)
            return None
        facts, notes, publish = known.facts, node.notes, known.publish
        if publish is not None and publish.event:
            publish = replace(publish, event=self._event(frame, publish.event))
        element = Element(
            name,
            path,
            address,
            node.access,
            known.type,
            display,
            known.checked,
            publish,
            frame.link,
            self._span(node.name),
            notes.documentation,
            facts.unit,
            known.words,
            facts.scale,
            facts.offset,
            facts.minimum,
            facts.maximum,
            facts.overflow,
            facts.initial,
            facts.safe,
            annotations_of(notes, self.evaluator, names) if notes.annotations else (),
            "" if index is None else node.name.text,
            index,
        )
        if frame.part is not None:
            element, place = frame.part.take(element, number)
            if place is None:
                return element
            number = place
        start, end = self.reporter.place(number.start, number.end)
        if start != number.start:  # an element of a component: the user of the component gave the address
            number = replace(number, start=start, end=end)
        self.placed.append(Placed(self._root, element, number, statement))
        return element

    def _event(self, frame: _Frame, event: str) -> str:
        """An event of the component or FIFO itself, or of one below it, gets its whole path. Others stay."""
        if frame.component is not None and event in frame.component.events:
            return f"{frame.path}.{event}"
        if event == frame.link.event_at(""):
            return frame.link.event_at(frame.path)
        if "." in event and frame.path:
            return f"{frame.path}.{event}"
        return event

    def _display(self, node: ElementNode, names: Mapping[str, Value], path: str) -> str | None:
        for one in node.properties:
            if one.key == "ID" and one.argument is not None:
                return self.evaluator.text(one.argument, names, "ID")
        return path

    def _span(self, name: Name) -> Span:
        span = self._spans.get(name.start)
        if span is None:
            span = self._spans[name.start] = self.reporter.sources.span(name.start, name.end)
        return span
