# SPDX-License-Identifier: BSD-3-Clause
"""The types of values as VHDL: the type of a record's field, and the place of its bits in words."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from unitylink.spec.model import Element
from unitylink.spec.types import EnumType, ValueType

from ..quoting import Vhdl
from .names import Names, identifier

SLOT = 32  # bits of each word in the ports of the design, whatever the width of the bus

# Names that packages of ieee declare and that users of a generated package use beside it.
IEEE_NAMES = {"rising_edge", "falling_edge", "to_unsigned", "to_signed", "to_integer", "resize", "std_match"}
IEEE_NAMES |= {"to_01", "shift_left", "shift_right", "to_bit", "to_stdulogic", "to_string", "to_hstring"}
IEEE_NAMES |= {"std_logic", "bit", "integer", "natural", "positive", "boolean", "real"}
# kind of a value -> array of bits, with a range of `width` bits
ARRAYS = {
    "uint": "unsigned",
    "int": "signed",
    "float": "std_ulogic_vector",
    "fixed": "signed",
    "ufixed": "unsigned",
    "enum": "unsigned",
}


@dataclass(frozen=True)
class Part:
    """Bits `low` to `high` of a raw value. `path` follows the field's name, and is "" for the whole value."""

    path: Vhdl
    base: str  # "std_ulogic", or the array type to which std_ulogic_vector is converted
    low: int
    high: int


@dataclass(frozen=True)
class FieldType:
    """The type of a record's field: its VHDL name, and its parts."""

    text: Vhdl
    parts: tuple[Part, ...]


@dataclass(frozen=True)
class Declaration:
    """A declaration in the user's package: its lines."""

    lines: tuple[Vhdl, ...]


class ValueTypes:
    """Declares the types that values need: a subtype for an enumeration, a record for packed bits."""

    def __init__(self, names: Names, data_bits: int) -> None:
        self.names = names
        self.data_bits = data_bits
        self.declarations: list[Declaration] = []
        self._declared: dict[ValueType, FieldType] = {}
        self._arrays = {"std_ulogic": "std_ulogic_vector"}

    def of(self, element: Element) -> FieldType:
        """Return the type of an element's field.

        If it is wider than the element's words, it has the width of the words.
        """
        return self._type(element.type, width_of(element, self.data_bits))

    def _type(self, kind: ValueType, width: int) -> FieldType:
        if kind.kind == "bool":
            return FieldType(Vhdl("std_ulogic"), (Part(Vhdl(""), "std_ulogic", 0, 0),))
        if kind.kind == "bits" and kind.fields:
            if kind not in self._declared:
                self._declared[kind] = self._packed(kind)
            return self._declared[kind]
        base = ARRAYS.get(kind.kind, "std_ulogic_vector")
        part = Part(Vhdl(""), base, 0, width - 1)
        if kind.enum is not None:
            if kind not in self._declared:
                self._declared[kind] = FieldType(self._enumeration(kind.enum), (part,))
            return self._declared[kind]
        return FieldType(Vhdl.of("{}({} downto 0)", base, width - 1), (part,))

    def array_of(self, text: Vhdl) -> str:
        """Return the type of several such values side by side. `text` is the type of one."""
        if text not in self._arrays:
            plain = re.sub(r"\((\d+) downto 0\)", lambda m: f"_{int(m[1]) + 1}", text).removesuffix("_t")
            self._arrays[text] = self.names.claim(f"{plain}_array_t")
            line = Vhdl.of("type {} is array (natural range <>) of {};", self._arrays[text], text)
            self.declarations.append(Declaration((line,)))
        return self._arrays[text]

    def _enumeration(self, enum: EnumType) -> Vhdl:
        """Declare constants, and not a VHDL enumeration, because the PC may write a number without a name."""
        name = self.names.claim(f"{enum.name}_t")
        lines = [Vhdl.of("subtype {} is unsigned({} downto 0);", name, enum.width - 1)]
        for value in enum.values:
            constant = self.names.claim(f"{enum.name}_{value.name}")
            number = format(value.value & (1 << enum.width) - 1, f"0{enum.width}b")
            line = Vhdl.of('constant {} : {} := "{}";', constant, name, number)
            about = f"{value.value}: {value.documentation}" if value.documentation else ""
            lines.append(line.with_remark(about))
        self.declarations.append(Declaration(tuple(lines)))
        return Vhdl.of("{}", name)

    def _packed(self, kind: ValueType) -> FieldType:
        scope, parts, fields, constants = Names(type_names(f.type for f in kind.fields)), [], [], []
        name = self.names.claim(f"{kind.name}_t")
        for field in kind.fields:
            field_name = scope.claim(field.name)
            inner = self._type(field.type, field.high - field.low + 1)
            about = f"bit {field.low}" if field.low == field.high else f"bits {field.high} to {field.low}"
            about += f": {field.documentation}" if field.documentation else ""
            fields.append(Vhdl.of("  {} : {};", field_name, inner.text).with_remark(about))
            for part in inner.parts:
                low, high = part.low + field.low, part.high + field.low
                parts.append(Part(Vhdl.of(".{}{}", field_name, part.path), part.base, low, high))
            for end, bit in (("low", field.low), ("high", field.high)):
                constant = self.names.claim(f"{kind.name}_{field.name}_{end}")
                constants.append(Vhdl.of("constant {} : natural := {};", constant, bit))
        head, end = Vhdl.of("type {} is record", name), Vhdl("end record;")
        self.declarations.append(Declaration((head, *fields, end)))
        self.declarations.append(Declaration(tuple(constants)))
        return FieldType(Vhdl.of("{}", name), tuple(parts))


def type_names(kinds: Iterable[ValueType]) -> set[str]:
    """Return the names of the VHDL types of these values. A field of such a name would hide its type."""
    return {f"{identifier(kind.name)}_t" for kind in kinds if kind.name}


def width_of(element: Element, data_bits: int) -> int:
    """Return the bits of an element's raw value on a bus of this width."""
    return data_bits if element.type.bus else min(element.type.width, element.words * data_bits)


def slices(index: int, low: int, high: int, data_bits: int) -> Iterator[tuple[int, int, int]]:
    """Yield, high bits first, (high, low) in a vector of words, and the lowest bit of the value there.

    A word holds `data_bits` bits of the value. The lowest ones are in word `index`.

    >>> list(slices(2, 4, 20, 16))
    [(100, 96, 16), (79, 68, 4)]
    """
    for word in range(high // data_bits, low // data_bits - 1, -1):
        first = max(low, word * data_bits)
        last = min(high, (word + 1) * data_bits - 1)
        start = SLOT * (index + word) - word * data_bits
        yield start + last, start + first, first
