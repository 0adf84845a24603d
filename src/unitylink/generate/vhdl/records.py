# SPDX-License-Identifier: BSD-3-Clause
"""The spec's tree as VHDL records, so that a word has the name it has in Python: `to_pc.j1.cpos`."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from unitylink.spec.model import Element, Instance, Spec

from .names import Names, remark
from .words import WordMap


@dataclass(frozen=True)
class Field:
    name: str
    type: str
    remark: str  # "" where name and type say all


@dataclass(frozen=True)
class Record:
    """A record type; expansions of one constructor with the same fields share it."""

    name: str
    fields: tuple[Field, ...]

    @property
    def width(self) -> int:
        """Characters of the longest field name."""
        return max(len(field.name) for field in self.fields)


@dataclass(frozen=True)
class Leaf:
    """A word in the top record: `path` from there on ("j1.cpos") and its index in the ports of the design."""

    path: str
    type: str
    index: int

    @property
    def kind(self) -> str:
        """The type without its range: signed or unsigned."""
        return self.type.partition("(")[0]


@dataclass(frozen=True)
class Tree:
    """The records of one direction, each after those it uses, the top one last; none without words."""

    records: tuple[Record, ...]
    leaves: tuple[Leaf, ...]

    @property
    def type(self) -> str:
        """The top record's name."""
        return self.records[-1].name


def to_pc(spec: Spec, words: WordMap, names: Names, word: Callable[[Element], str]) -> Tree:
    """Plan what the user's logic gives the PC to read.

    Elements of several devices may share an address: the word has one field, that of the first of them.
    """
    first: dict[int, Element] = {}
    for _, element in spec.walk():
        if words.drives(element):
            first.setdefault(element.address, element)
    chosen = {id(element) for element in first.values()}
    return _Maker("to_pc", names, words.read, lambda element: id(element) in chosen, word).tree(spec)


def from_pc(spec: Spec, words: WordMap, names: Names, word: Callable[[Element], str]) -> Tree:
    """Plan what the PC wrote."""
    return _Maker("from_pc", names, words.write, words.sees, word).tree(spec)


def written(spec: Spec, words: WordMap, names: Names) -> Tree:
    """Plan the strobes that say that the PC has just written."""
    return _Maker("written", names, words.write, words.sees, lambda element: "std_ulogic").tree(spec)


class _Maker:
    """Walks the tree once and collects record types and leaves."""

    def __init__(
        self,
        direction: str,
        names: Names,
        indices: Mapping[int, int],
        chosen: Callable[[Element], bool],
        word: Callable[[Element], str],
    ) -> None:
        self.direction = direction
        self.names = names
        self.indices = indices
        self.chosen = chosen
        self.word = word
        self.types: dict[tuple[str, tuple[tuple[str, str], ...]], Record] = {}
        self.leaves: list[Leaf] = []

    def tree(self, spec: Spec) -> Tree:
        top = self.names.claim(f"{spec.name}_{self.direction}_t")
        if len(spec.roots) == 1:
            self._record(spec.roots[0], "", top)
        else:
            scope = Names()
            fields = tuple(
                Field(name, record.name, "")
                for root in spec.roots
                for name in [scope.claim(root.name)]
                if (record := self._record(root, f"{name}.", None)) is not None
            )
            if fields:
                self.types["", ()] = Record(top, fields)
        return Tree(tuple(self.types.values()), tuple(self.leaves))

    def _record(self, instance: Instance, path: str, name: str | None) -> Record | None:
        """Return the type of an expansion, a new one where its shape is new; None where it has no field.

        `name` is that of the type where it is known, as it is for the top.
        """
        scope = Names()  # every member claims its name, so that it has the same one in all directions
        fields = []
        for member in instance.members:
            if isinstance(member, Element):
                field = scope.claim(member.name)
                if self.chosen(member):
                    kind = self.word(member)
                    fields.append(Field(field, kind, _about(member)))
                    self.leaves.append(Leaf(f"{path}{field}", kind, self.indices[member.address]))
            elif isinstance(member, Instance):
                field = scope.claim(member.name)
                record = self._record(member, f"{path}{field}.", None)
                if record is not None:
                    fields.append(Field(field, record.name, ""))
        if not fields:
            return None
        shape = (name or instance.constructor, tuple((field.name, field.type) for field in fields))
        if shape not in self.types:
            type_name = name or self.names.claim(f"{instance.constructor}_{self.direction}_t")
            self.types[shape] = Record(type_name, tuple(fields))
        return self.types[shape]


def _about(element: Element) -> str:
    unit = f"in {element.unit}" if element.unit else ""
    return remark(", ".join(part for part in (unit, element.documentation) if part))
