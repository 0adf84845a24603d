# SPDX-License-Identifier: BSD-3-Clause
"""Python classes of enumerations and packed values: `IntEnum`s and frozen dataclasses."""

from __future__ import annotations

import dataclasses
from enum import IntEnum
from functools import cache
from typing import Any

from unitylink.spec.types import EnumType, ValueType

from .names import python_names

# What members and fields cannot be called, because the classes have it already.
ENUM_RESERVED = frozenset({*dir(IntEnum), *dir(int), "name", "value", "mro"})
RECORD_RESERVED = frozenset({*dir(object), "bool", "float", "int"})  # and what annotations are made of


def member_names(enum: EnumType) -> dict[str, str]:
    """Return {name in the spec: name of the member}."""
    return python_names([item.name for item in enum.values], ENUM_RESERVED)


def field_names(bits: ValueType) -> dict[str, str]:
    """Return {name in the spec: attribute}."""
    return python_names([field.name for field in bits.fields], RECORD_RESERVED)


@cache
def enum_class(enum: EnumType) -> type[IntEnum]:
    """Return an IntEnum with the members of an enumeration; the same one each time.

    >>> from unitylink.spec.types import EnumValue
    >>> enum_class(EnumType("mode", 2, (EnumValue("idle", 0), EnumValue("run", 1))))["run"]
    <mode.run: 1>
    """
    names = member_names(enum)
    members: list[tuple[str, int]] = [(names[item.name], item.value) for item in enum.values]
    made: type[IntEnum] = IntEnum(enum.name, members)  # type: ignore[misc]  # names are known at run time
    return made


@cache
def record_class(bits: ValueType) -> type[Any]:
    """Return a frozen dataclass with the fields of a packed value; the same one each time."""
    names = field_names(bits)
    return dataclasses.make_dataclass(
        bits.name or "Bits", [(names[field.name], Any) for field in bits.fields], frozen=True
    )
