# SPDX-License-Identifier: BSD-3-Clause
"""The meaning of every name in a text, and its uses, for editors.

It works on the syntax tree, so it also works for a text with mistakes.

>>> symbols = find_symbols("public a() { @x = 0x1: READ(); g = x; }")
>>> [(s.kind, s.name, len(s.references)) for s in symbols.all]
[('constructor', 'a', 0), ('element', 'x', 1), ('group', 'g', 0)]
"""

from __future__ import annotations

import os
from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from types import MappingProxyType

from ..report.diagnostics import Reporter
from ..source import Source, Sources
from ..text.imports import Importer
from ..text.syntax import (
    BitsNode,
    ConstantNode,
    ConstructorNode,
    DeclarationNode,
    ElementNode,
    EnumNode,
    ExpansionNode,
    Expression,
    GroupNode,
    LinkKindNode,
    LinkNode,
    MemberNode,
    Name,
    Notes,
    Program,
    Property,
    Step,
    TypeNode,
)
from .type_names import names_of

_MEMBER_KINDS = {ElementNode: "element", ExpansionNode: "instance", GroupNode: "group"}


@dataclass(eq=False)
class Symbol:
    """One name with one meaning.

    `kind` is "constructor", "parameter", "address", "element", "instance", "group", "constant", "enum",
    "value" (of an enumeration), "bits", "field" or "link". `container` is the thing to which it belongs. An
    address and the member that takes it are one symbol. `declared` is its place in the head, and `defined` is
    the member's place.
    """

    kind: str
    name: str
    container: str = ""
    declared: Name | None = None
    defined: Name | None = None
    references: list[Name] = field(default_factory=list)
    documentation: str = ""

    @property
    def places(self) -> list[Name]:
        """Every place of the name, in the order of the text."""
        own = [name for name in (self.declared, self.defined) if name is not None]
        return sorted([*own, *self.references], key=lambda name: name.start)

    def target(self, offset: int) -> Name:
        """Return where a name is defined.

        For a member that takes an address, this is the head, else the member.
        """
        at_member = self.defined is not None and self.defined.start <= offset <= self.defined.end
        first = self.declared if at_member else self.defined
        found = first or self.declared or self.defined
        assert found is not None  # every symbol has a place
        return found


@dataclass
class Scope:
    """The symbols of one constructor, and the range of its text."""

    node: ConstructorNode
    start: int
    end: int
    parameters: dict[str, Symbol] = field(default_factory=dict)
    # name -> symbol; addresses too, because they share their names with members
    members: dict[str, Symbol] = field(default_factory=dict)
    callees: dict[str, str] = field(default_factory=dict)  # instance -> its constructor


class Symbols:
    """All symbols of a text and of its imports. Offsets beyond the text are in the files of `sources`."""

    def __init__(self, program: Program, sources: Sources) -> None:
        self.sources = sources
        self.constructors: dict[str, Symbol] = {}
        self.constants: dict[str, Symbol] = {}
        self.types: dict[str, Symbol] = {}
        self.links: dict[str, Symbol] = {}
        self.items: dict[
            str, dict[str, Symbol]
        ] = {}  # for an enumeration its values, for packed bits its fields
        self._by_name: dict[str, Scope] = {}
        for declaration in program.declarations:
            self._declare_one(declaration)
        nodes = sorted(program.constructors, key=lambda node: node.name.start)
        scopes = [self._declare(node) for node in nodes]
        for scope, following in pairwise(scopes):
            scope.end = min(scope.end, following.start)
        for declaration in program.declarations:
            self._refer_declaration(declaration)
        for scope in scopes:
            self._refer_notes(scope.node.notes, scope)
            for parameter in scope.node.parameters:
                self._refer_names([parameter.default], scope)
            self._refer_names([scope.node.block], scope)
            for member in scope.node.members:
                self._refer(scope, member)
        length = len(sources.first.text)
        self.scopes = [scope for scope in scopes if scope.start <= length]  # only the scopes of this text
        places = [(place, symbol) for symbol in self.all for place in symbol.places]
        self._places = sorted(places, key=lambda found: found[0].start)
        self._starts = [place.start for place, _ in self._places]

    @property
    def all(self) -> Iterator[Symbol]:
        """Every symbol: constructor by constructor, then the other declarations."""
        for name, symbol in self.constructors.items():
            yield symbol
            scope = self._by_name[name]
            yield from scope.parameters.values()
            yield from scope.members.values()
        for table in (self.constants, self.types, self.links, *self.items.values()):
            yield from table.values()

    def at(self, offset: int) -> tuple[Symbol, Name] | None:
        """Return the symbol whose name stands at `offset` (or ends there), and the place of the name."""
        index = bisect_right(self._starts, offset) - 1
        if index < 0:
            return None
        place, symbol = self._places[index]
        return (symbol, place) if offset <= place.end else None

    def scope_at(self, offset: int) -> Scope | None:
        """Return the constructor of this text that contains `offset`."""
        return next((scope for scope in reversed(self.scopes) if scope.start <= offset), None)

    def scope_of(self, constructor: str) -> Scope | None:
        """Return the scope of a constructor by its name."""
        return self._by_name.get(constructor)

    # --- declarations ---------------------------------------------------------------------------------------

    def _declare_one(self, node: DeclarationNode) -> None:
        table, kind = {
            ConstantNode: (self.constants, "constant"),
            EnumNode: (self.types, "enum"),
            BitsNode: (self.types, "bits"),
            LinkNode: (self.links, "link"),
        }[type(node)]
        name = node.name.text
        self._once(table, Symbol(kind, name, defined=node.name, documentation=node.notes.documentation))
        if isinstance(node, (EnumNode, BitsNode)):
            items = self.items.setdefault(name, {})
            inner = "value" if isinstance(node, EnumNode) else "field"
            for item in node.values if isinstance(node, EnumNode) else node.fields:
                text = item.notes.documentation
                self._once(items, Symbol(inner, item.name.text, name, defined=item.name, documentation=text))

    def _declare(self, node: ConstructorNode) -> Scope:
        source = self.sources.at(node.name.start)
        scope = Scope(node, node.name.start, source.base + len(source.text))
        name = node.name.text
        if name in self.constructors:  # a second declaration is reported elsewhere, and counts here as a use
            self.constructors[name].references.append(node.name)
        else:
            text = node.notes.documentation
            self.constructors[name] = Symbol("constructor", name, defined=node.name, documentation=text)
            self._by_name[name] = scope
        for parameter in node.parameters:
            self._once(scope.parameters, Symbol("parameter", parameter.text, name, declared=parameter))
        for address in node.addresses:
            self._once(scope.members, Symbol("address", address.text, name, declared=address))
        for member in node.members:
            if isinstance(member, LinkKindNode):
                continue
            kind = _MEMBER_KINDS.get(type(member), "member")
            text = getattr(member, "notes", Notes()).documentation
            known = scope.members.get(member.name.text)
            if known is not None and known.defined is None:
                known.kind, known.defined, known.documentation = kind, member.name, text
            else:
                one = Symbol(kind, member.name.text, name, defined=member.name, documentation=text)
                self._once(scope.members, one)
            if isinstance(member, ExpansionNode):
                scope.callees.setdefault(member.name.text, member.callee.text)
        return scope

    @staticmethod
    def _once(table: dict[str, Symbol], symbol: Symbol) -> None:
        first = table.setdefault(symbol.name, symbol)
        if first is not symbol:
            first.references.extend(symbol.places)

    # --- references -----------------------------------------------------------------------------------------

    def _refer_declaration(self, node: DeclarationNode) -> None:
        self._refer_notes(node.notes, None)
        if isinstance(node, ConstantNode):
            self._refer_names([node.value], None)
        elif isinstance(node, LinkNode):
            self._refer_properties(node.properties, None, None)
        else:
            self._refer_type(node.type, None)
            if isinstance(node, EnumNode):
                self._refer_names([item.value for item in node.values], None)
            else:
                for item in node.fields:
                    self._refer_type(item.type, None)
                    self._refer_names([item.high, item.low], None)
                    self._refer_properties(item.properties, None, item.type)

    def _refer(self, scope: Scope, member: MemberNode) -> None:
        notes = getattr(member, "notes", None)
        if isinstance(notes, Notes):
            self._refer_notes(notes, scope)
        if isinstance(member, LinkKindNode):
            self._refer_properties(member.properties, scope, None)
        elif isinstance(member, ElementNode):
            self._refer_names([member.fixed, member.count], scope)
            if member.type is not None:
                self._refer_type(member.type, scope)
            self._refer_properties(member.properties, scope, member.type)
        elif isinstance(member, ExpansionNode):
            self._note(self.constructors, member.callee)
            callee = self._by_name.get(member.callee.text)
            for argument in member.arguments:
                if callee is not None:
                    self._note(callee.parameters, argument.key)
            self._refer_names([member.count, *member.arguments], scope)
            for binding in member.bindings:
                if callee is not None:
                    self._note(callee.members, binding.name)
                self._refer_names(binding.numbers, scope)
        elif isinstance(member, GroupNode):
            for path in member.paths:
                self._follow(scope, path)

    def _refer_notes(self, notes: Notes, scope: Scope | None) -> None:
        for annotation in notes.annotations:
            self._refer_names(annotation.arguments, scope)

    def _refer_properties(
        self, properties: Sequence[Property], scope: Scope | None, kind: TypeNode | None
    ) -> None:
        values = self.items.get(kind.name.text, {}) if kind is not None else {}
        for one in properties:
            if one.key == "LINK":
                self._note(self.links, one.name)
            elif one.key in ("INITIAL", "SAFE") and one.name is not None and one.name.text in values:
                self._note(values, one.name)
            elif one.key not in ("OVERFLOW", "NODES"):
                self._refer_names([one.argument], scope)
            if one.publish is not None:
                self._refer_names(one.publish.arguments, scope)

    def _refer_type(self, kind: TypeNode, scope: Scope | None) -> None:
        self._note(self.types, kind.name)
        self._refer_names(kind.arguments, scope)

    def _refer_names(self, expressions: Iterable[Expression | None], scope: Scope | None) -> None:
        """A name in an expression is a parameter, an address of the constructor, or a constant."""
        for expression in expressions:
            for name in names_of(expression) if expression is not None else ():
                table = self.constants
                if scope is not None and name.text in scope.parameters:
                    table = scope.parameters
                elif scope is not None and (own := scope.members.get(name.text)) and own.declared:
                    table = scope.members
                self._note(table, name)

    def _follow(self, scope: Scope, path: list[Step]) -> None:
        here: Scope | None = scope
        for step in path:
            self._refer_names([step.index], scope)
            if here is not None:
                self._note(self.constructors if step.all else here.members, step.name)
                callee = step.name.text if step.all else here.callees.get(step.name.text, "")
                here = self._by_name.get(callee)

    @staticmethod
    def _note(table: dict[str, Symbol], name: Name | None) -> None:
        if name is not None and name.text in table:
            table[name.text].references.append(name)


def find_symbols(
    text: str,
    file: str = "<text>",
    include: Sequence[str | os.PathLike[str]] = (),
    opened: Mapping[str, str] = MappingProxyType({}),
) -> Symbols:
    """Return the symbols of a text and of its imports, even with mistakes in it. See `compile_text`."""
    reporter = Reporter(Source(file, text))
    importer = Importer(reporter, include, opened)
    importer.add_components()
    return Symbols(importer.program, reporter.sources)
