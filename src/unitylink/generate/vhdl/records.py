# SPDX-License-Identifier: BSD-3-Clause
"""The spec's tree as VHDL records. So a word has the same name as in Python: `to_pc.j1.cpos`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import groupby

from unitylink.spec.model import Element, Group, Instance, Member, Spec

from ..quoting import Vhdl
from .names import Names
from .value_types import Declaration, FieldType, Part, type_names


@dataclass(frozen=True)
class Leaf:
    """A part of a value in the top record: its path there ("j(1).cpos"), its word, and its bits there."""

    path: Vhdl
    index: int
    part: Part


@dataclass(frozen=True)
class Tree:
    """The record types of one direction, each after those that it uses. `type` is the top one, or ""."""

    type: Vhdl
    declarations: tuple[Declaration, ...]
    leaves: tuple[Leaf, ...]


def records(
    spec: Spec,
    direction: str,
    names: Names,
    index_of: Callable[[Element], int],
    type_of: Callable[[Element], FieldType | None],
    *,
    array_of: Callable[[Vhdl], str],
) -> Tree:
    """Plan the records of a direction.

    `type_of` gives the type of an element, or None if it has no field there. `array_of` names the type of
    several values side by side.
    """
    return _Maker(direction, names, index_of, type_of, array_of=array_of).tree(spec)


@dataclass(frozen=True)
class _Item:
    """A planned field: its name, the text of its type, and its leaves."""

    name: str
    type: Vhdl
    remark: str
    leaves: tuple[Leaf, ...]


class _Maker:
    """Walks through the tree once and collects record types.

    Each member gets a name, even if it has no field. So a member has the same name in all directions.
    """

    def __init__(
        self,
        direction: str,
        names: Names,
        index_of: Callable[[Element], int],
        type_of: Callable[[Element], FieldType | None],
        *,
        array_of: Callable[[Vhdl], str],
    ) -> None:
        self.direction = direction
        self.names = names
        self.index_of = index_of
        self.type_of = type_of
        self.records: dict[tuple[str, tuple[tuple[str, Vhdl], ...]], str] = {}
        self.array_of = array_of
        self.types: set[str] = set()  # names of types that no field may have
        self.arrays: dict[Vhdl, str] = {}
        self.declarations: list[Declaration] = []

    def tree(self, spec: Spec) -> Tree:
        top = self.names.claim(f"{spec.name}_{self.direction}_t")
        self.types = type_names(element.type for _, element in spec.walk())
        items = self._items(spec.roots[0].members if len(spec.roots) == 1 else spec.roots)
        if not items:
            return Tree(Vhdl(""), (), ())
        self._declare(top, items)
        leaves = tuple(leaf for item in items for leaf in item.leaves)
        return Tree(Vhdl.of("{}", top), tuple(self.declarations), leaves)

    def _items(self, members: tuple[Member, ...]) -> list[_Item]:
        scope = Names(self.types)
        items: list[_Item] = []
        words = [member for member in members if not isinstance(member, Group)]
        for array, group in groupby(words, lambda member: member.array):
            parts = list(group)
            if array:
                items += self._array(scope, array, parts)
            else:
                named = [self._item(scope.claim(part.name), part) for part in parts]
                items += [item for item in named if item is not None]
        return items

    def _array(self, scope: Names, array: str, parts: list[Element | Instance]) -> list[_Item]:
        """Return one field for all items of an array, or one field for each if the items differ."""
        name = scope.claim(array)
        items = [self._item("", part) for part in parts]
        whole = [item for item in items if item is not None]
        if len(whole) == len(parts) and len({item.type for item in whole}) == 1:
            array_of = self.array_of if isinstance(parts[0], Element) else self._array_of
            kind = Vhdl.of("{}(0 to {})", array_of(whole[0].type), len(whole) - 1)
            leaves = tuple(
                _moved(leaf, Vhdl.of("{}({})", name, number))
                for number, item in enumerate(whole)
                for leaf in item.leaves
            )
            return [_Item(name, kind, whole[0].remark, leaves)]
        named = [(scope.claim(part.name), item) for part, item in zip(parts, items, strict=True)]
        return [
            _Item(single, item.type, item.remark, tuple(_moved(leaf, single) for leaf in item.leaves))
            for single, item in named
            if item is not None
        ]

    def _array_of(self, record: Vhdl) -> str:
        if record not in self.arrays:
            self.arrays[record] = self.names.claim(f"{record.removesuffix('_t')}_array_t")
            self._say(Vhdl.of("type {} is array (natural range <>) of {};", self.arrays[record], record))
        return self.arrays[record]

    def _item(self, name: str, member: Element | Instance) -> _Item | None:
        if isinstance(member, Element):
            kind = self.type_of(member)
            if kind is None:
                return None
            index = self.index_of(member)
            leaves = tuple(Leaf(Vhdl.of("{}{}", name, part.path), index, part) for part in kind.parts)
            about = _about(member) if self.direction in ("to_pc", "from_pc") else ""
            return _Item(name, kind.text, about, leaves)
        items = self._items(member.members)
        if not items:
            return None
        leaves = tuple(_moved(leaf, name, Vhdl(".")) for item in items for leaf in item.leaves)
        return _Item(name, self._record(member.constructor, items), "", leaves)

    def _record(self, constructor: str, items: list[_Item]) -> Vhdl:
        shape = (constructor, tuple((item.name, item.type) for item in items))
        if shape not in self.records:
            self.records[shape] = self.names.claim(f"{constructor}_{self.direction}_t")
            self._declare(self.records[shape], items)
        return Vhdl.of("{}", self.records[shape])

    def _declare(self, name: str, items: list[_Item]) -> None:
        width = max(len(item.name) for item in items)
        fields = [
            Vhdl.of("  {} : {};", item.name.ljust(width), item.type).with_remark(item.remark)
            for item in items
        ]
        self._say(Vhdl.of("type {} is record", name), *fields, Vhdl("end record;"))

    def _say(self, *lines: Vhdl) -> None:
        self.declarations.append(Declaration(lines))


def _moved(leaf: Leaf, front: str, between: str = "") -> Leaf:
    return Leaf(Vhdl.of("{}{}{}", front, between, leaf.path), leaf.index, leaf.part)


def _about(element: Element) -> str:
    """Return the facts that the type does not show.

    Our own words come first, because tools obey some comments.
    """
    facts = []
    if element.type.kind in ("fixed", "ufixed"):
        facts.append(f"{element.type.fraction} bits behind the point")
    if element.type.kind == "float":
        facts.append("IEEE 754")
    if (element.scale, element.offset) != (1, 0):
        facts.append(f"value = raw * {element.scale:g} + {element.offset:g}")
    if element.unit:
        facts.append(f"in {element.unit}")
    if element.documentation:
        facts.append(f'"{element.documentation}"')
    return ", ".join(facts)
