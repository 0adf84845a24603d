# SPDX-License-Identifier: BSD-3-Clause
"""Names, patterns and addresses of the command line, resolved to words of the device."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from typing import TYPE_CHECKING

from unitylink.interface.wire_hash import part_behind
from unitylink.protocol import ADDRESS_BITS_MAX
from unitylink.spec.model import Element, Instance, Spec
from unitylink.spec.report.suggest import nearest
from unitylink.values import Quantity

from .failure import Failure

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

_ADDRESS = re.compile(r"0[xX][0-9a-fA-F_]+")
_GLOB = re.compile(r"[*?]")


@dataclass(frozen=True)
class Item:
    """A word of the device: an element of the spec, or a bare address that was typed (then `element` is
    None).
    """

    name: str
    address: int
    element: Element | None = None
    line: int | None = None  # the event line that publishes it

    @property
    def unit(self) -> str:
        return self.element.unit if self.element else ""

    @property
    def pollable(self) -> bool:
        """Whether it may be read without being named.

        It may not if a read changes something or has no meaning.
        """
        return self.element is None or self.element.access not in ("READCLEAR", "PULSE")

    @property
    def quantity(self) -> Quantity:
        return Quantity.of(self.element) if self.element else Quantity()


def matches(name: str, pattern: str) -> bool:
    """Tell whether a name matches a pattern with `*` and `?`. Brackets are those of an array.

    >>> matches("leg[0].knee", "leg[0].*"), matches("leg0.knee", "leg[0].*")
    (True, False)
    """
    return fnmatchcase(name, pattern.replace("[", "[[]"))


class Names:
    """All names of a spec, with search. There may be none."""

    def __init__(self, spec: Spec | None, source: str = "", *, part: Spec | None = None) -> None:
        """`part` is the named part, if it is not the whole spec."""
        self.spec = spec
        self.source = source or (spec.source if spec else "")
        part = part if part is not None else spec
        self.elements: dict[str, Element] = {}
        self.instances: dict[str, list[str]] = {}  # name -> names of all elements below
        self.groups: dict[str, list[str]] = {}  # name -> names of its elements
        self.lines: dict[str, int] = {}  # name -> event line
        if spec and part:
            several = len(spec.roots) > 1
            for device in part.devices:
                prefix = f"{device.root}." if several else ""
                for group in device.groups:
                    if group.trigger != "rate":
                        self.lines |= {prefix + element.path: group.number for element in group.elements}
            for root in part.roots:
                prefix = f"{root.name}." if several else ""
                self.elements |= {prefix + element.path: element for element in root.walk()}
                self._collect(root, prefix)

    def on(self, link: Link) -> Names:
        """Return the names of the gateware behind `link`. Raises DeviceMismatch if it has another spec."""
        if self.spec is None:
            return self
        return Names(self.spec, self.source, part=part_behind(link, self.spec))

    def _collect(self, instance: Instance, prefix: str) -> None:
        name = prefix + instance.path if instance.path else instance.name
        self.instances[name] = [prefix + element.path for element in instance.walk()]
        for group in instance.groups:
            self.groups[prefix + group.path] = [prefix + element.path for element in group.elements]
        for below in instance.instances:
            self._collect(below, prefix)

    def find(self, words: Sequence[str]) -> list[Item]:
        """Resolve names, patterns and addresses in the order typed. Each item comes once.

        The name of an instance or a group stands for its elements. Raises `Failure` for a word that finds
        nothing.
        """
        found: dict[str, Item] = {}
        for word in words:
            for item in self._find_one(word):
                found.setdefault(item.name, item)
        return list(found.values())

    def find_readable(self, words: Sequence[str]) -> list[Item]:
        """Resolve like `find`, but leave out items that a read changes, unless they are named themselves."""
        return [item for item in self.find(words) if item.pollable or item.name in words]

    def all(self) -> list[Item]:
        """Return every element of the spec, in source order."""
        return self._items(self.elements)

    def _items(self, names: Iterable[str]) -> list[Item]:
        return [
            Item(name, self.elements[name].address, self.elements[name], self.lines.get(name))
            for name in names
        ]

    def _find_one(self, word: str) -> list[Item]:
        if _ADDRESS.fullmatch(word):
            address = int(word, 16)
            if address >> ADDRESS_BITS_MAX:
                raise Failure(f"address {word} has more than {ADDRESS_BITS_MAX} bits")
            return [Item(f"0x{address:04X}", address)]
        if self.spec is None:
            raise Failure(
                f"'{word}' is a name, and names come from a spec",
                "add --spec FILE.ul, or give the address: 0x88",
            )
        if word in self.elements:
            return self._items([word])
        if word in self.groups or word in self.instances:
            return self._items(self.groups.get(word) or self.instances[word])
        if _GLOB.search(word):
            items = self._items(name for name in self.elements if matches(name, word))
            if items:
                return items
            raise Failure(f"the pattern '{word}' matches no item of {self.source}", self._advice("*"))
        raise Failure(f"there is no item '{word}' in {self.source}", self._advice(word))

    def _advice(self, word: str) -> str:
        meant = nearest(word, [*self.elements, *self.groups, *self.instances])
        listing = f"`unitylink list --spec {self.source}` shows all names"
        return f"did you mean '{meant}'? {listing}" if meant else listing
