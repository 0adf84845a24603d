# SPDX-License-Identifier: BSD-3-Clause
"""Macro expansion: from the syntax tree to the model."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Union

from ..protocol import BASE_HZ_DEFAULT, GROUP_SIZE_MAX
from .diagnostics import Reporter
from .graph import MAX_DEPTH, MAX_ITEMS, Graph
from .members import check_members, declaration
from .model import Element, Group, Instance, LinkBinding, Member, Publish, Span
from .scope import ADDRESS_MAX, Scope, Scopes
from .syntax import Argument, ElementNode, ExpansionNode, GroupNode, Name, Number, Program, Step, Text
from .types import INT32, UINT32

MAX_STRING = 250  # characters of an evaluated string


@dataclass(frozen=True)
class _RunTime:
    """The value of a run-time parameter: which parameter of the public constructor it is."""

    name: str


@dataclass(frozen=True)
class _Vector:
    """Addresses as they were bound; `start` to `end` is the binding, `statement` the member it stands in."""

    numbers: list[Number]
    start: int
    end: int
    statement: int


@dataclass(frozen=True)
class Placed:
    """An element with the place its address is written at, for checks that speak about addresses."""

    root: str
    element: Element
    address: Number
    statement: int  # where the member that gave the address starts


_Values = dict[str, Union[str, _RunTime]]


@dataclass
class _Frame:
    """One expansion under way."""

    scope: Scope
    path: str
    values: _Values
    vectors: dict[str, _Vector]
    link: LinkBinding


class Resolver:
    """Expands the public constructors of a program; `roots` are instances, `placed` all their elements."""

    def __init__(self, program: Program, reporter: Reporter) -> None:
        self.reporter = reporter
        self.scopes = Scopes(program, reporter)
        self.roots: list[Instance] = []
        self.placed: list[Placed] = []
        check_members(self.scopes)
        self._graph = Graph(self.scopes, reporter)
        self._root = ""
        self._spans: dict[int, Span] = {}
        # (constructor, address taken as one word or "") -> wrong vectors and users; one user of a right one
        self._lengths: dict[tuple[str, str], tuple[dict[int, tuple[_Vector, Name]], list[Name]]] = {}
        self._members: dict[str, dict[str, Member]] = {}  # path -> members by name, while a root is expanded
        self._by_constructor: dict[str, dict[str, list[Instance]]] = {}
        publics = [scope for scope in self.scopes.all if scope.node.public]
        if not publics and not program.damaged and not any(s.node.broken for s in self.scopes.all):
            self._report_no_public(program)
        items = 0
        for scope in publics:
            if scope.node.broken or self.scopes.first.get(scope.node.name.text) is not scope:
                continue
            items += self._graph.sizes[scope.node.name.text].items
            if self._may_expand(scope, items):
                self._expand_root(scope)
        self._report_lengths()

    # --- roots ----------------------------------------------------------------------------------------------

    def _report_no_public(self, program: Program) -> None:
        if program.constructors:
            at = program.constructors[0].name
            hint = f"write `public {at.text}(…)` for the one that is the interface"
            self.reporter.report("UL029", at.start, at.end, "there is no public constructor", hint)
        else:
            hint = "a spec has at least one: `public robot(ctrl,comm) { … }`"
            self.reporter.report("UL029", 0, 0, "there is no public constructor", hint)

    def _may_expand(self, scope: Scope, items: int) -> bool:
        at = scope.node.name
        size = self._graph.sizes[at.text]
        if scope.addresses:
            message = f"public constructor `{at.text}` takes addresses, but nothing binds them"
            hint = "remove `public`, or fix each address: `@name = 0x…: …`"
            self.reporter.report("UL036", at.start, at.end, message, hint)
        elif items > MAX_ITEMS:
            shown = f"{items:,}" if items < 10**9 else "more than a billion"
            message = f"with `{at.text}` the spec expands to {shown} instances, elements and group members"
            self.reporter.report("UL038", at.start, at.end, message, f"at most {MAX_ITEMS:,} are allowed")
        elif size.depth > MAX_DEPTH:
            message = f"the expansion of `{at.text}` is {size.depth:,} constructors deep"
            self.reporter.report("UL039", at.start, at.end, message, f"at most {MAX_DEPTH} are allowed")
        else:
            return True
        return False

    def _expand_root(self, scope: Scope) -> None:
        name = scope.node.name
        self._root = name.text
        runtime = [p.text for p in scope.node.parameters if p.text in scope.runtime]
        values: _Values = {p: _RunTime(p) if p in scope.runtime else p for p in scope.parameters}
        frame = _Frame(scope, "", values, {}, LinkBinding("memory"))
        self.roots.append(
            self._expand(frame, name.text, name.text, self._span(name.start, name.end), tuple(runtime))
        )
        self._members.clear()
        self._by_constructor.clear()

    # --- expansion ------------------------------------------------------------------------------------------

    def _expand(
        self, frame: _Frame, name: str, display: str, span: Span, parameters: tuple[str, ...] = ()
    ) -> Instance:
        scope = frame.scope
        if scope.tosnet is not None:
            frame.link = self._tosnet(frame)
        prefix = f"{frame.path}." if frame.path else ""
        found: dict[str, Member] = {}
        groups = False
        for node in scope.usable.values():
            text = node.name.text
            if isinstance(node, ElementNode):
                element = self._element(frame, node, prefix + text)
                if element is not None:
                    found[text] = element
            elif isinstance(node, ExpansionNode):
                instance = self._instance(frame, node, prefix + text)
                if instance is not None:
                    found[text] = instance
            else:
                groups = True
        self._members[frame.path] = found
        if groups:
            self._add_groups(frame, found, prefix)
        members = tuple(found[text] for text in scope.usable if text in found)
        return Instance(
            name, frame.path, scope.node.name.text, display, frame.link, members, parameters, span
        )

    def _instance(self, frame: _Frame, node: ExpansionNode, path: str) -> Instance | None:
        callee = self.scopes.first[node.callee.text]
        values: _Values = {}
        display = ""
        for parameter, argument in zip(callee.node.parameters, node.arguments, strict=True):
            value = self._value(frame, argument)
            if value is None:
                return None
            values[parameter.text] = value
            if isinstance(value, str) and not display:
                display = value
        vectors = self._bind(frame, node, callee)
        if vectors is None:
            return None
        inner = _Frame(callee, path, values, vectors, frame.link)
        return self._expand(
            inner, node.name.text, display or path, self._span(node.name.start, node.name.end)
        )

    def _bind(self, frame: _Frame, node: ExpansionNode, callee: Scope) -> dict[str, _Vector] | None:
        """Return the callee's vectors; the scope has checked all but forwarded lengths."""
        names = [name.text for name in callee.node.addresses]
        if node.forwards:
            vector = frame.vectors[node.name.text]
            if not callee.node.tuple_form:
                return {names[0]: vector}
            return self._take_apart(vector, names, node)
        vectors: dict[str, _Vector] = {}
        for position, one in enumerate(node.bindings):
            vector = _Vector(one.numbers, one.start, one.end, node.name.start)
            if one.name is None and callee.node.tuple_form:
                return self._take_apart(vector, names, node)
            vectors[one.name.text if one.name else names[position]] = vector
        return vectors

    def _take_apart(
        self, vector: _Vector, names: list[str], node: ExpansionNode
    ) -> dict[str, _Vector] | None:
        fits = len(vector.numbers) == len(names)
        if node.forwards:
            self._note_length((node.callee.text, ""), vector, fits, node.name)
        if fits:
            return {
                n: _Vector([a], a.start, a.end, vector.statement)
                for n, a in zip(names, vector.numbers, strict=True)
            }
        return None

    def _note_length(self, key: tuple[str, str], vector: _Vector, fits: bool, user: Name) -> None:
        wrong, right = self._lengths.setdefault(key, ({}, []))
        if not fits:
            wrong[vector.start] = vector, user
        elif not right:
            right.append(user)

    def _report_lengths(self) -> None:
        """Report each wrong vector; but where several all have one wrong length, their user is wrong."""
        for (constructor, address), (wrong, right) in self._lengths.items():
            scope = self.scopes.first[constructor]
            names = scope.node.addresses
            takes = f"`{address}` is one word" if address else f"`{constructor}` takes {len(names)} addresses"
            counts = {len(vector.numbers) for vector, _ in wrong.values()}
            if len(wrong) > 1 and len(counts) == 1 and not right:
                at = next((name for name in names if name.text == address), scope.node.name)
                message = f"{takes}, but all {len(wrong)} vectors it is given have {counts.pop()}"
                hint = f"make `{declaration(scope)}` agree with them"
                if address:
                    hint = f"take them apart in a constructor of its own: `@{address}: …(…)`"
                self.reporter.report("UL031", at.start, at.end, message, hint)
                continue
            for vector, user in wrong.values():
                does = "but is bound to" if address else f"but `{user.text}` forwards"
                message = f"{takes} {does} these {len(vector.numbers)}"
                hint = f"they are used in line {self.reporter.source.line_of(user.start)}"
                self.reporter.report("UL031", vector.start, vector.end, message, hint)

    def _tosnet(self, frame: _Frame) -> LinkBinding:
        """What a TOSNET does not give comes from the one around it; BASE does not: it is 0 unless given."""
        link, scope = frame.link, frame.scope
        names: dict[str, str | None] = {"CTRL": link.ctrl, "COMM": link.comm}
        for key in names:
            one = scope.link_property(key)
            if one is not None and one.name is not None:
                value = frame.values.get(one.name.text)
                names[key] = value.name if isinstance(value, _RunTime) else None
        base = scope.link_property("BASE")
        offset = base.numbers[0].value if base is not None else 0
        return LinkBinding("tosnet", min(offset, ADDRESS_MAX), names["CTRL"], names["COMM"])

    def _element(self, frame: _Frame, node: ElementNode, path: str) -> Element | None:
        if node.fixed is not None:
            number, statement = node.fixed, node.name.start
        else:
            vector = frame.vectors[node.name.text]
            fits = len(vector.numbers) == 1
            key = (frame.scope.node.name.text, node.name.text)
            self._note_length(key, vector, fits, node.name)
            if not fits:
                return None
            number, statement = vector.numbers[0], vector.statement
        address = frame.link.base + number.value
        if address > ADDRESS_MAX:
            message = f"with BASE 0x{frame.link.base:X} this address is 0x{address:X}, beyond 32 bits"
            self.reporter.report(
                "UL050", number.start, number.end, message, f"the largest is 0x{ADDRESS_MAX:X}"
            )
            return None
        display: str = path
        checked = False
        publish: Publish | None = None
        for one in node.properties:
            if one.key == "CRC":
                checked = True
            elif one.key == "PUBLISH":
                mode, divisor = (number.value for number in one.numbers)
                publish = Publish(mode, divisor, BASE_HZ_DEFAULT / divisor)
            elif one.argument is not None:
                value = self._value(frame, one.argument)
                if not isinstance(value, str):
                    return None
                display = value
        span = self._span(node.name.start, node.name.end)
        element = Element(
            node.name.text,
            path,
            address,
            node.access,
            INT32 if node.signed else UINT32,
            display,
            checked,
            publish,
            frame.link,
            span,
        )
        self.placed.append(Placed(self._root, element, number, statement))
        return element

    def _value(self, frame: _Frame, argument: Argument) -> str | _RunTime | None:
        """Return the value of an argument, or None after a diagnostic."""
        parts = argument.parts
        first = parts[0]
        if len(parts) == 1 and not isinstance(first, Text):
            return frame.values.get(first.text)
        texts: list[str] = []
        length = 0
        for part in parts:
            value = part.value if isinstance(part, Text) else frame.values.get(part.text)
            if not isinstance(value, str):
                return None
            texts.append(value)
            length += len(value)
            if length > MAX_STRING:
                message = f"this string is longer than {MAX_STRING} characters"
                self.reporter.report("UL040", argument.start, argument.end, message, "shorten it")
                return None
        return "".join(texts)

    # --- groups ---------------------------------------------------------------------------------------------

    def _add_groups(self, frame: _Frame, found: dict[str, Member], prefix: str) -> None:
        """Make the groups of one instance; one that lists another is made after it."""
        waiting = [node for node in frame.scope.usable.values() if isinstance(node, GroupNode)]
        names = {node.name.text for node in waiting}
        needed = {
            n.name.text: [p[0].name.text for p in n.paths if not p[0].all and p[0].name.text in names]
            for n in waiting
        }
        by_name = {node.name.text: node for node in waiting}
        for first in waiting:
            stack = [first.name.text]
            while stack:
                text = stack[-1]
                missing = [name for name in needed[text] if name not in found]
                if missing:
                    stack.extend(missing)
                    continue
                stack.pop()
                if text not in found:
                    found[text] = self._group(frame, by_name[text], prefix + text)

    def _group(self, frame: _Frame, node: GroupNode, path: str) -> Group:
        elements: dict[str, Element] = {}
        for steps in node.paths:
            for element in self._elements(steps, frame.path):
                if element.path in elements:
                    at = steps[0].name
                    message = f"`{element.path}` is in group `{node.name.text}` already"
                    self.reporter.report("UL069", at.start, steps[-1].name.end, message, "list it once")
                elements[element.path] = element
        if len(elements) > GROUP_SIZE_MAX:
            message = f"group `{node.name.text}` has {len(elements):,} elements"
            hint = f"a message carries at most {GROUP_SIZE_MAX}: divide it into several groups"
            self.reporter.report("UL068", node.name.start, node.name.end, message, hint)
        return Group(
            node.name.text, path, tuple(elements.values()), self._span(node.name.start, node.name.end)
        )

    def _elements(self, steps: list[Step], path: str) -> list[Element]:
        paths = [path]
        reached: list[Member] = []
        for step in steps:
            name = step.name.text
            if step.all:
                reached = [one for at in paths for one in self._expansions(at).get(name, ())]
            else:
                reached = [self._members[at][name] for at in paths if name in self._members[at]]
            paths = [member.path for member in reached if isinstance(member, Instance)]
        elements: list[Element] = []
        for member in reached:
            if isinstance(member, Element):
                elements.append(member)
            else:
                elements.extend(member.walk() if isinstance(member, Instance) else member.elements)
        return elements

    def _expansions(self, path: str) -> dict[str, list[Instance]]:
        """Return the instances directly below `path` by their constructor."""
        known = self._by_constructor.get(path)
        if known is None:
            known = self._by_constructor[path] = {}
            for member in self._members[path].values():
                if isinstance(member, Instance):
                    known.setdefault(member.constructor, []).append(member)
        return known

    def _span(self, start: int, end: int) -> Span:
        span = self._spans.get(start)
        if span is None:
            span = self._spans[start] = self.reporter.source.span(start, end)
        return span
