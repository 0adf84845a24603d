# SPDX-License-Identifier: BSD-3-Clause
"""The syntax tree: what stands in the text, before names have a meaning. Offsets count characters from 0."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Union


@dataclass(slots=True)
class Name:
    """A name where it is written."""

    text: str
    start: int
    end: int


@dataclass(slots=True)
class Number:
    """A number where it is written; a value beyond 64 bits is kept as 2**64."""

    value: int
    start: int
    end: int


@dataclass(slots=True)
class Text:
    """A string literal; `value` is without quotes and escapes."""

    value: str
    start: int
    end: int


@dataclass(slots=True)
class Argument:
    """Strings and parameters put together with `+`."""

    parts: list[Text | Name]
    start: int
    end: int


@dataclass(slots=True)
class Property:
    """`ID=…`, `CRC`, `PUBLISH(…)`, `CTRL=…`, `COMM=…`, `BASE=…`; `key` is COMM for UART too."""

    key: str
    start: int
    end: int
    argument: Argument | None = None  # ID
    name: Name | None = None  # CTRL, COMM
    numbers: list[Number] = field(default_factory=list)  # BASE one, PUBLISH two


@dataclass(slots=True)
class Binding:
    """`@ (0x1,0x2)`, `@l=(0x1,0x2)` or `@l=0x1` after an expansion."""

    name: Name | None
    numbers: list[Number]
    start: int
    end: int


@dataclass(slots=True)
class Step:
    """One step of a group's path: a name, or `ALL(constructor)`."""

    name: Name
    all: bool


@dataclass(slots=True)
class TosNetNode:
    """`TOSNET(CTRL=…, COMM=…, BASE=…)`"""

    properties: list[Property]
    start: int
    end: int


@dataclass(slots=True)
class ExpansionNode:
    """`name: constructor(arguments) bindings`; `forwards` if it is `@name: constructor(arguments)`."""

    name: Name
    callee: Name
    arguments: list[Argument]
    bindings: list[Binding]
    forwards: bool


@dataclass(slots=True)
class ElementNode:
    """`@name: signed READ(properties)`; `fixed` is the address of `@name = 0x1: …`."""

    name: Name
    fixed: Number | None
    signed: bool
    access: str
    properties: list[Property]


@dataclass(slots=True)
class GroupNode:
    """`name = path, path`"""

    name: Name
    paths: list[list[Step]]


@dataclass(slots=True)
class BrokenNode:
    """A member with a syntax error: its name stays known, so that its use elsewhere is no second mistake."""

    name: Name


MemberNode = Union[TosNetNode, ExpansionNode, ElementNode, GroupNode, BrokenNode]


@dataclass(slots=True)
class ConstructorNode:
    """A constructor; `broken` if its head has a syntax error, so that it is not known what it takes;
    `incomplete` if members are missing that may have been meant to be there."""

    public: bool
    name: Name
    parameters: list[Name] = field(default_factory=list)
    addresses: list[Name] = field(default_factory=list)
    tuple_form: bool = False  # `@ (a,b)`: one vector taken apart; else each address is a vector
    members: list[MemberNode] = field(default_factory=list)
    broken: bool = False
    incomplete: bool = False


@dataclass(slots=True)
class Program:
    """A whole file; `damaged` if part of it could not be read at all, so that names may be missing."""

    package: str = ""
    name: str = ""
    constructors: list[ConstructorNode] = field(default_factory=list)
    damaged: bool = False
