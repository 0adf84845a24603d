# SPDX-License-Identifier: BSD-3-Clause
"""The plan of typed objects in C, C++ and Rust. Every decision is taken here: a template only lays it out."""

from __future__ import annotations

from dataclasses import dataclass

from ..quoting import Code
from .facts import LinkFacts, MemoryFacts


@dataclass(frozen=True)
class TypeName:
    """The type of a value. `get` and `put` are the functions of C that decode and encode it."""

    name: Code
    get: str = ""
    put: str = ""


@dataclass(frozen=True)
class EnumMember:
    name: str
    value: int
    remark: Code


@dataclass(frozen=True)
class EnumPlan:
    """An enumeration. `numbers` is the name of the table of its numbers."""

    name: str
    base: Code  # the type that holds its numbers
    get: str
    put: str
    numbers: str
    remark: Code
    members: tuple[EnumMember, ...]
    values: tuple[Code, ...]
    open: bool


@dataclass(frozen=True)
class FieldPlan:
    name: str
    type: TypeName
    low: int
    remark: Code


@dataclass(frozen=True)
class BitsPlan:
    """A packed value. `table` is the name of the table of its fields, `facts` its initialisers."""

    name: str
    get: str
    put: str
    table: str
    remark: Code
    fields: tuple[FieldPlan, ...]
    facts: tuple[Code, ...]


@dataclass(frozen=True)
class SetMember:
    """A member of a set: a value, or the set of a part. `count` 0: it is no array.

    `places` are the values' places in the robot's table, counted from the first one of the set's owner. For
    the set of a part, they are the places of the part's first value.
    """

    name: str
    type: TypeName
    count: int
    places: tuple[int, ...]
    part: SetPlan | None
    initial: Code  # "" if there is none
    remark: Code


@dataclass(frozen=True)
class SetPlan:
    """Values that are read together, or written together, as one struct."""

    name: str
    members: tuple[SetMember, ...]
    values: tuple[int, ...]  # places of all values, in order
    words: int


@dataclass(frozen=True)
class ValuePlan:
    """A value as a member. `count` 0: it is no array. `stem`: the beginning of its functions' names in C."""

    name: str
    stem: str
    access: str
    type: TypeName
    places: tuple[int, ...]
    count: int
    remark: Code


@dataclass(frozen=True)
class PartPlan:
    """A part as a member. Each place is that of a part's first value; the paths are those of the parts."""

    name: str
    type: str
    places: tuple[int, ...]
    paths: tuple[Code, ...]
    count: int
    remark: Code


@dataclass(frozen=True)
class GroupPlan:
    """A group as a member: another name for some values. `stem` begins its functions' names in C."""

    name: str
    stem: str
    path: Code
    inputs: SetPlan
    outputs: SetPlan
    remark: Code


@dataclass(frozen=True)
class ClassPlan:
    name: str
    remark: Code
    values: tuple[ValuePlan, ...]
    parts: tuple[PartPlan, ...]
    groups: tuple[GroupPlan, ...]
    inputs: SetPlan
    outputs: SetPlan


@dataclass(frozen=True)
class StreamPlan:
    """Values that the gateware publishes together."""

    name: str
    stem: str
    path: Code
    divisor: int
    set: SetPlan
    remark: Code


@dataclass(frozen=True)
class RobotPlan:
    """A public constructor: its class, its tables, and what it publishes."""

    plan: ClassPlan
    path: Code
    space: str  # the prefix of its tables
    links: tuple[LinkFacts, ...]
    memories: tuple[MemoryFacts, ...]
    values: tuple[Code, ...]
    slots: int
    streams: tuple[StreamPlan, ...]


@dataclass(frozen=True)
class ObjectsPlan:
    """All that a header has. `sets` are in an order in which each one comes after those it needs."""

    name: str
    source: Code
    file: Code
    hash: str
    enums: tuple[EnumPlan, ...]
    bits: tuple[BitsPlan, ...]
    sets: tuple[SetPlan, ...]
    classes: tuple[ClassPlan, ...]
    robots: tuple[RobotPlan, ...]
