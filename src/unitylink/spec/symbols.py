# SPDX-License-Identifier: BSD-3-Clause
"""What every name in a text stands for, and where it is used: what an editor asks for.

It works on the syntax tree, so it also answers for a text that has mistakes.

>>> symbols = find_symbols("public a() { @x = 0x1: READ(); g = x; }")
>>> [(s.kind, s.name, len(s.references)) for s in symbols.all]
[('constructor', 'a', 0), ('element', 'x', 1), ('group', 'g', 0)]
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass, field

from .diagnostics import Reporter
from .parser import parse
from .source import Source
from .syntax import (
    BrokenNode,
    ConstructorNode,
    ElementNode,
    ExpansionNode,
    Expression,
    GroupNode,
    LinkKindNode,
    Name,
    Program,
    Step,
)
from .type_names import names_of


@dataclass(eq=False)
class Symbol:
    """One name with one meaning.

    `kind` is "constructor", "parameter", "address", "element", "instance" or "group"; `container` the
    constructor it belongs to. An address and the member that takes it are one symbol: `declared` is its place
    in the head, `defined` the member's.
    """

    kind: str
    name: str
    container: str
    declared: Name | None = None
    defined: Name | None = None
    references: list[Name] = field(default_factory=list)

    @property
    def places(self) -> list[Name]:
        """Every place where the name stands, in the order of the text."""
        own = [name for name in (self.declared, self.defined) if name is not None]
        return sorted([*own, *self.references], key=lambda name: name.start)

    def target(self, offset: int) -> Name:
        """Return where a name is defined: for a member that takes an address the head, else the member."""
        at_member = self.defined is not None and self.defined.start <= offset <= self.defined.end
        first = self.declared if at_member else self.defined
        found = first or self.declared or self.defined
        assert found is not None  # a symbol stands somewhere
        return found


@dataclass
class Scope:
    """The symbols of one constructor and where its text begins and ends."""

    node: ConstructorNode
    start: int
    end: int
    parameters: dict[str, Symbol] = field(default_factory=dict)
    members: dict[str, Symbol] = field(default_factory=dict)  # addresses too: they share their names
    callees: dict[str, str] = field(default_factory=dict)  # instance -> its constructor


class Symbols:
    """All symbols of a text."""

    def __init__(self, program: Program, length: int) -> None:
        self.constructors: dict[str, Symbol] = {}
        self.scopes: list[Scope] = []
        self._by_name: dict[str, Scope] = {}
        for node in program.constructors:
            self._declare(node, length)
        for scope in self.scopes:
            for member in scope.node.members:
                self._refer(scope, member)
        places = [(place, symbol) for symbol in self.all for place in symbol.places]
        self._places = sorted(places, key=lambda found: found[0].start)
        self._starts = [place.start for place, _ in self._places]

    @property
    def all(self) -> Iterator[Symbol]:
        """Every symbol, constructor by constructor."""
        for name, symbol in self.constructors.items():
            yield symbol
            scope = self._by_name[name]
            yield from scope.parameters.values()
            yield from scope.members.values()

    def at(self, offset: int) -> tuple[Symbol, Name] | None:
        """Return the symbol whose name stands at `offset` (or ends there), and the place."""
        index = bisect_right(self._starts, offset) - 1
        if index < 0:
            return None
        place, symbol = self._places[index]
        return (symbol, place) if offset <= place.end else None

    def scope_at(self, offset: int) -> Scope | None:
        """Return the constructor `offset` lies in."""
        return next((scope for scope in reversed(self.scopes) if scope.start <= offset), None)

    def scope_of(self, constructor: str) -> Scope | None:
        """Return the scope of a constructor by its name."""
        return self._by_name.get(constructor)

    # --- declarations ---------------------------------------------------------------------------------------

    def _declare(self, node: ConstructorNode, length: int) -> None:
        if self.scopes:
            self.scopes[-1].end = node.name.start
        scope = Scope(node, node.name.start, length)
        self.scopes.append(scope)
        name = node.name.text
        if name in self.constructors:  # declared twice: reported elsewhere, and here it is another use
            self.constructors[name].references.append(node.name)
        else:
            self.constructors[name] = Symbol("constructor", name, "", defined=node.name)
            self._by_name[name] = scope
        for parameter in node.parameters:
            self._once(scope.parameters, Symbol("parameter", parameter.text, name, declared=parameter))
        for address in node.addresses:
            self._once(scope.members, Symbol("address", address.text, name, declared=address))
        for member in node.members:
            if isinstance(member, LinkKindNode):
                continue
            kind = {ElementNode: "element", ExpansionNode: "instance", GroupNode: "group"}.get(
                type(member), "member"
            )
            known = scope.members.get(member.name.text)
            if known is not None and known.defined is None:
                known.kind, known.defined = kind, member.name
            else:
                self._once(scope.members, Symbol(kind, member.name.text, name, defined=member.name))
            if isinstance(member, ExpansionNode):
                scope.callees.setdefault(member.name.text, member.callee.text)

    @staticmethod
    def _once(table: dict[str, Symbol], symbol: Symbol) -> None:
        first = table.setdefault(symbol.name, symbol)
        if first is not symbol:
            first.references.extend(symbol.places)

    # --- references -----------------------------------------------------------------------------------------

    def _refer(self, scope: Scope, member: object) -> None:
        if isinstance(member, LinkKindNode):
            for one in member.properties:
                self._refer_expression(scope, one.argument)
        elif isinstance(member, ElementNode):
            for one in member.properties:
                self._refer_expression(scope, one.argument)
            self._refer_expression(scope, member.fixed)
            self._refer_expression(scope, member.count)
        elif isinstance(member, ExpansionNode):
            self._note(self.constructors, member.callee)
            for argument in member.arguments:
                self._refer_expression(scope, argument)
            self._refer_expression(scope, member.count)
            callee = self._by_name.get(member.callee.text)
            for binding in member.bindings:
                for number in binding.numbers:
                    self._refer_expression(scope, number)
                if callee is not None:
                    self._note(callee.members, binding.name)
        elif isinstance(member, GroupNode):
            for path in member.paths:
                self._follow(scope, path)
        else:
            assert isinstance(member, BrokenNode)  # nothing more is known of it

    def _refer_expression(self, scope: Scope, node: Expression | None) -> None:
        for name in names_of(node) if node is not None else ():
            self._note(scope.parameters if name.text in scope.parameters else scope.members, name)

    def _follow(self, scope: Scope, path: list[Step]) -> None:
        here: Scope | None = scope
        for step in path:
            if here is None:
                return
            self._note(self.constructors if step.all else here.members, step.name)
            callee = step.name.text if step.all else here.callees.get(step.name.text, "")
            here = self._by_name.get(callee)

    @staticmethod
    def _note(table: dict[str, Symbol], name: Name | None) -> None:
        if name is not None and name.text in table:
            table[name.text].references.append(name)


def find_symbols(text: str, file: str = "<text>") -> Symbols:
    """Return the symbols of a text, whatever mistakes it has."""
    program, _ = parse(Reporter(Source(file, text)))
    return Symbols(program, len(text))
