# SPDX-License-Identifier: BSD-3-Clause
"""Python classes of enumerations and packed values: `IntEnum`s and frozen dataclasses."""

from __future__ import annotations

import dataclasses
from enum import IntEnum
from functools import cache
from typing import Any

from unitylink.spec.types import EnumType, ValueType

from .names import python_names

# Names that members and fields cannot have, because the classes already have them.
ENUM_RESERVED = frozenset({*dir(IntEnum), *dir(int), "name", "value", "mro"})
_OF_NUMBERS = frozenset("bcdoxXneEfFgG%")  # the last letters of formats that are only for numbers
RECORD_RESERVED = frozenset({*dir(object), "bool", "float", "int"})  # also the names that annotations use


def member_names(enum: EnumType) -> dict[str, str]:
    """Return {name in the spec: name of the member}."""
    return python_names([item.name for item in enum.values], ENUM_RESERVED)


def field_names(bits: ValueType) -> dict[str, str]:
    """Return {name in the spec: attribute}."""
    return python_names([field.name for field in bits.fields], RECORD_RESERVED)


class Enumeration(IntEnum):
    """The base of enumerations. Members are numbers, and are printed as their names.

    >>> mode = Enumeration("mode", {"idle": 0, "run": 1})
    >>> print(mode.run, f"{mode.run:>5}", f"{mode.run:d}", mode.run + 1)
    run   run 1 2
    """

    def __str__(self) -> str:
        return self.name

    def __format__(self, form: str) -> str:
        return format(int(self) if form[-1:] in _OF_NUMBERS else self.name, form)


@cache
def enum_class(enum: EnumType) -> type[IntEnum]:
    """Return an Enumeration with the members of an enumeration. Equal types give the same class.

    >>> from unitylink.spec.types import EnumValue
    >>> enum_class(EnumType("mode", 2, (EnumValue("idle", 0), EnumValue("run", 1))))["run"]
    <mode.run: 1>
    """
    names = member_names(enum)
    members: list[tuple[str, int]] = [(names[item.name], item.value) for item in enum.values]
    made: type[IntEnum] = Enumeration(enum.name, members)  # type: ignore[assignment, arg-type, call-arg]  # members at run time
    return made


@cache
def record_class(bits: ValueType) -> type[Any]:
    """Return a frozen dataclass with the fields of a packed value. Equal types give the same class."""
    names = field_names(bits)
    return dataclasses.make_dataclass(
        bits.name or "Bits", [(names[field.name], Any) for field in bits.fields], frozen=True
    )
