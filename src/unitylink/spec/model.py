# SPDX-License-Identifier: BSD-3-Clause
"""The resolved specification: what every generator, tool and layer reads, frozen.

A `Spec` is a tree. Each public constructor is one root `Instance`; an instance holds, in source order,
`Instance`s (expansions), `Element`s (words at an address) and `Group`s (aliases of elements). Two instances
of one constructor with the same shape share `constructor`, so a generator can make one class per constructor.
All addresses are final: word addresses on the bus with the link binding's BASE already added.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Union


@dataclass(frozen=True)
class Span:
    """Where something stands in a source file; line and column count from 1, offsets from 0 in characters."""

    file: str
    line: int
    column: int
    start: int
    end: int


@dataclass(frozen=True)
class Publish:
    """How an element publishes: `mode` 1 = hardware (the gateware sends), 2 = software (the PC polls);
    `divisor` divides the gateware's base publish frequency (base 1000 Hz, 10 -> 100 Hz)."""

    mode: int
    divisor: int


@dataclass(frozen=True)
class LinkBinding:
    """The hardware proxy an instance and all below it are reached through.

    `kind` is "memory" (plain memory, the default at base 0) or "tosnet". `ctrl` and `comm` name the run-time
    parameters of the public constructor that bound it; None means the default.
    """

    kind: str
    base: int = 0
    ctrl: str | None = None
    comm: str | None = None


@dataclass(frozen=True)
class Element:
    """One word the PC reads (access "READ") or writes (access "WRITE")."""

    name: str
    path: str  # dotted, without the root: "j1.cpos"
    address: int
    access: str
    signed: bool
    display: str  # ID as evaluated ("joint 1:cpos"); the path where the spec gives none
    checked: bool  # CRC
    publish: Publish | None
    link: LinkBinding
    span: Span
    documentation: str = ""
    unit: str = ""


@dataclass(frozen=True)
class Group:
    """An alias for a list of elements: one write, one snapshot, one callback."""

    name: str
    path: str
    elements: tuple[Element, ...]
    span: Span


@dataclass(frozen=True)
class Instance:
    """One expansion of a constructor. The root instance of a public constructor has path ""."""

    name: str
    path: str
    constructor: str
    display: str  # value of the first string argument, else the path
    link: LinkBinding
    members: tuple[Member, ...]
    parameters: tuple[str, ...]  # run-time (CTRL/COMM) parameters; only on roots
    span: Span

    @property
    def instances(self) -> tuple[Instance, ...]:
        return tuple(m for m in self.members if isinstance(m, Instance))

    @property
    def elements(self) -> tuple[Element, ...]:
        return tuple(m for m in self.members if isinstance(m, Element))

    @property
    def groups(self) -> tuple[Group, ...]:
        return tuple(m for m in self.members if isinstance(m, Group))

    def walk(self) -> Iterator[Element]:
        """Yield every element below, in source order."""
        for member in self.members:
            if isinstance(member, Element):
                yield member
            elif isinstance(member, Instance):
                yield from member.walk()


Member = Union[Instance, Element, Group]


@dataclass(frozen=True)
class Spec:
    """A compiled UL-spec.

    `hash` is 16 hex digits over what reaches the wire and the interface (names, addresses, access, sign, CRC,
    publish, links, groups), not over comments, layout or display names; `source` is the file's name without
    folders.
    """

    name: str
    package: str
    source: str
    hash: str
    roots: tuple[Instance, ...]

    def root(self, name: str | None = None) -> Instance:
        """Return the public constructor `name`, or the only one; raise KeyError naming the choices."""
        for root in self.roots:
            if root.name == name or (name is None and len(self.roots) == 1):
                return root
        choices = ", ".join(r.name for r in self.roots)
        raise KeyError(f"no public constructor {name!r}; there are: {choices}")

    def walk(self) -> Iterator[tuple[str, Element]]:
        """Yield (qualified path, element); with several roots the path starts with the root's name."""
        several = len(self.roots) > 1
        for root in self.roots:
            for element in root.walk():
                yield (f"{root.name}.{element.path}" if several else element.path), element
