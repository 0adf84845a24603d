# SPDX-License-Identifier: BSD-3-Clause
"""The types of values, and how they are stored in words. Generators and the codec use them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Union

from .annotation import Annotation

Number = Union[int, float]  # whole numbers stay whole, because a float has 53 bits and a value up to 64

# Kinds whose raw value is two's complement.
_SIGNED = ("int", "fixed")


@dataclass(frozen=True)
class EnumValue:
    """One named number of an enumeration."""

    name: str
    value: int
    documentation: str = ""


@dataclass(frozen=True)
class EnumType:
    """`enum NAME : u2 { idle = 0; run = 1 }`. An `open` enumeration accepts other numbers, as numbers."""

    name: str
    width: int
    values: tuple[EnumValue, ...]
    open: bool = False
    documentation: str = ""
    annotations: tuple[Annotation, ...] = ()


@dataclass(frozen=True)
class ValueType:
    """How a value is stored in its bits.

    `kind` is "bool", "uint", "int", "float" (IEEE 754, 32 or 64 bits), "fixed", "ufixed" (`fraction` of the
    `width` bits are after the point), "enum" (see `enum`) or "bits" (packed `fields`, with `name` as its
    name).

    >>> ValueType("fixed", 16, 8).text
    'fixed(8,8)'
    """

    kind: str
    width: int
    fraction: int = 0
    enum: EnumType | None = None
    fields: tuple[Field, ...] = ()
    name: str = ""  # name of an enumeration or of packed bits
    documentation: str = ""
    annotations: tuple[Annotation, ...] = ()
    # true if the width is that of the device's data bus, whatever `width` the link has declared
    bus: bool = False

    @property
    def signed(self) -> bool:
        """Is the raw value two's complement?"""
        return self.kind in _SIGNED

    @property
    def numeric(self) -> bool:
        """Is the value a number, which may have a scale, a unit and limits?"""
        return self.kind in ("uint", "int", "float", "fixed", "ufixed")

    @property
    def text(self) -> str:
        """The type as it is written in a spec."""
        if self.name:
            return self.name
        if self.bus:
            return "signed" if self.signed else "unsigned"
        if self.kind in ("fixed", "ufixed"):
            return f"{self.kind}({self.width - self.fraction},{self.fraction})"
        letter = {"uint": "u", "int": "i", "float": "f"}.get(self.kind)
        return f"{letter}{self.width}" if letter else self.kind


@dataclass(frozen=True)
class Field:
    """Bits `high` to `low` of a packed value. Its engineering value is raw * `scale` + `offset` in `unit`."""

    name: str
    type: ValueType
    low: int
    high: int
    documentation: str = ""
    unit: str = ""
    scale: Number = 1
    offset: Number = 0
    minimum: Number | None = None
    maximum: Number | None = None


UINT32 = ValueType("uint", 32, bus=True)
INT32 = ValueType("int", 32, bus=True)
