# SPDX-License-Identifier: BSD-3-Clause
"""The members of a class in MATLAB: which values are properties, and which are methods."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from unitylink.spec.model import Spec
from unitylink.spec.types import ValueType
from unitylink.values import Codec, Quantity

from ..objects import ObjectsPlan
from ..objects.facts import RobotFacts
from ..objects.names import Names
from ..objects.plan import ClassPlan, RobotPlan, SetMember, ValuePlan
from ..quoting import Code, Matlab
from .dialect import MATLAB

_DOUBLE = 1 << 53  # the first whole number whose neighbour is no double


@dataclass(frozen=True)
class Method:
    """A value that is no property: reading it changes it, or it is only pulsed or cleared."""

    name: str
    value: ValuePlan
    reads: bool


@dataclass(frozen=True)
class TableOfRobot:
    """What the MEX file needs beside the plan: for each value, its fields and its first raw number."""

    fields: tuple[Code, ...]
    initial: tuple[Code, ...]


def taken(plan: ClassPlan, value: ValuePlan) -> bool:
    """Return whether reading a value takes something out of the device."""
    sampled = set(value.places) <= set(plan.inputs.values)
    return value.access == "READCLEAR" or (value.access == "READ" and not sampled)


def properties(plan: ClassPlan) -> list[ValuePlan]:
    """Return the values that are properties."""
    return [value for value in plan.values if value.access != "PULSE" and not taken(plan, value)]


def methods(plan: ClassPlan, robot: RobotPlan | None, reserved: frozenset[str]) -> list[Method]:
    """Return the methods of values: take_, clear_ and pulse_ with the name of the value."""
    names = {one.name for kind in (plan.values, plan.parts, plan.groups) for one in kind}
    names |= {stream.name for stream in robot.streams} if robot is not None else set()
    scope = Names({*names, *reserved})
    made = []
    for value in plan.values:
        if taken(plan, value):
            made.append(Method(scope.claim(f"take_{value.name}"), value, reads=True))
        elif value.access == "W1C":
            made.append(Method(scope.claim(f"clear_{value.name}"), value, reads=False))
        elif value.access == "PULSE":
            made.append(Method(scope.claim(f"pulse_{value.name}"), value, reads=False))
    return made


def list_of(numbers: tuple[int, ...]) -> Matlab:
    return Matlab.of("[{}]", Matlab(", ").join(list(numbers)))


def number(value: int) -> Code:
    """Return the number of an enumeration: plain, or with 64 bits if a double does not hold it."""
    return Matlab.of("{}", value) if value < _DOUBLE else MATLAB.number(value)


def row(member: SetMember) -> Matlab:
    """Return what a set says of a member: its name, how many it has, and the set of a part."""
    inner = Matlab.of("sets.{}", member.type.name) if member.part is not None else Matlab("[]")
    return Matlab.of("{{{}, {}, {}}}", Matlab.text(member.name), member.count, inner)


def field_rows(plan: ObjectsPlan, table: str) -> Iterator[Matlab]:
    """Yield what a table says of each field of a packed value: its name, its facts, and its own fields."""
    tables = {str(bits.name): bits.table for bits in plan.bits}
    (packed,) = [bits for bits in plan.bits if bits.table == table]
    for field, facts in zip(packed.fields, packed.facts, strict=True):
        inner = Matlab.of("{}", tables.get(str(field.type.name), "")) or Matlab("[]")
        yield Matlab.of("{{{}, {}, {}}}", Matlab.text(field.name), facts, inner)


def table_of(spec: Spec, plan: ObjectsPlan, number: int) -> TableOfRobot:
    """Return the table of the robot with this number."""
    facts = RobotFacts(spec, spec.roots[number], MATLAB)
    tables = {bits.name: made.table for bits, made in zip(spec.bits, plan.bits, strict=True)}
    fields, initial = [], []
    for element in facts.elements:
        packed = element.type.kind == "bits" and not Quantity.of(element).scaled
        fields.append(Matlab.of("{}", tables[element.type.name]) if packed else Matlab("[]"))
        raw = _first(element.type)
        if element.initial is not None:
            raw = Codec(element.path, Quantity.of(element), facts.width(element)).encode(element.initial)
        initial.append(MATLAB.number(raw))
    return TableOfRobot(tuple(fields), tuple(initial))


def _first(kind: ValueType) -> int:
    """Return the raw number of a value without INITIAL: 0, or the first that an enumeration has instead."""
    if kind.enum is not None:
        numbers = [one.value for one in kind.enum.values]
        return 0 if kind.enum.open or 0 in numbers else numbers[0]
    return sum(_first(field.type) << field.low for field in kind.fields)
