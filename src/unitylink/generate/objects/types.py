# SPDX-License-Identifier: BSD-3-Clause
"""Enumerations and packed values as types of C and C++, and values as literals."""

from __future__ import annotations

from typing import Any

from unitylink.spec.model import Spec
from unitylink.spec.types import EnumType, ValueType
from unitylink.values import Codec, Quantity, field_names

from ..quoting import Cpp
from .documentation import sentences
from .facts import field_value, kind_of, member_numbers
from .names import members
from .plan import BitsPlan, EnumMember, EnumPlan, FieldPlan, TypeName
from .style import Style

_ENUM = (("Numbers",), ("_get", "_put", "_numbers"))
_BITS = (("Fields",), ("_get", "_put", "_fields"))


def whole_bits(width: int) -> int:
    return next(bits for bits in (8, 16, 32, 64) if width <= bits)


class Types:
    """The types of a spec in one style."""

    def __init__(self, spec: Spec, style: Style) -> None:
        self.style = style
        self.enums: dict[str, EnumPlan] = {}
        self.bits: dict[str, BitsPlan] = {}
        for enum in spec.enums:
            self.enums[enum.name] = self._enum(enum)
        for bits in spec.bits:
            self.bits[bits.name] = self._bits(bits)

    def of(self, quantity: Quantity, width: int) -> TypeName:
        """Return the type of a value that has `width` bits."""
        kind = quantity.type
        read_as = kind_of(kind, quantity)
        if read_as in ("SCALED", "REAL"):
            return TypeName(Cpp("double"), "ul_get_double", "ul_put_double")
        if read_as == "BOOL":
            return TypeName(Cpp("bool"), "ul_get_bool", "ul_put_bool")
        if read_as == "ENUM" and kind.enum is not None:
            plan = self.enums[kind.enum.name]
            return TypeName(Cpp.of("{}", plan.name), plan.get, plan.put)
        if read_as == "BITS":
            packed = self.bits[kind.name]
            return TypeName(Cpp.of("{}", packed.name), packed.get, packed.put)
        bits, letter = whole_bits(width), "" if kind.signed else "u"
        std = Cpp("" if self.style.plain else "std::")
        short = f"{letter or 'i'}{bits}"
        return TypeName(Cpp.of("{}{}int{}_t", std, letter, bits), f"ul_get_{short}", f"ul_put_{short}")

    def table_of(self, kind: ValueType) -> Cpp:
        """Return the name of the table of an enumeration's numbers, or a null pointer."""
        if kind.enum is None:
            return Cpp("NULL" if self.style.plain else "nullptr")
        return Cpp.of("{}", self.enums[kind.enum.name].numbers)

    def literal(self, quantity: Quantity, width: int, value: Any) -> Cpp:
        """Return a value of the spec as a literal of its type."""
        codec = Codec("initial", quantity, width)
        return self._literal(quantity, width, codec.encode(value))

    def _literal(self, quantity: Quantity, width: int, raw: int) -> Cpp:
        kind = quantity.type
        read_as = kind_of(kind, quantity)
        if read_as == "BITS":
            fields = []
            for one in kind.fields:
                size = one.high - one.low + 1
                fields.append(self._literal(Quantity.of(one), size, raw >> one.low & (1 << size) - 1))
            return Cpp.of("{{{}}}", Cpp(", ").join(fields))
        if read_as == "BOOL":
            return Cpp("true") if raw & 1 else Cpp("false")
        if read_as == "ENUM":
            number = Cpp.of("{}U", raw)
            return number if self.style.plain else Cpp.of("{}{{{}}}", self.of(quantity, width).name, number)
        number = Codec("initial", quantity, width).decode(raw)
        if read_as in ("SCALED", "REAL"):
            return Cpp.of("{}", float(number))
        if number == -(1 << 63):
            return Cpp("INT64_MIN")
        return Cpp.of("{}" if kind.signed else "{}U", int(number))

    def _enum(self, enum: EnumType) -> EnumPlan:
        style = self.style
        name = style.typedef(enum.name, _ENUM)
        names = members([item.name for item in enum.values])
        if style.plain:
            names = {
                item.name: style.scope.claim(f"{name.removesuffix('_t')}_{item.name}".upper())
                for item in enum.values
            }
        rows = [
            EnumMember(names[item.name], item.value, Cpp.remark(item.documentation)) for item in enum.values
        ]
        other = "; other numbers stay numbers" if enum.open else ""
        said = sentences(enum.documentation, f"The enumeration `{enum.name}` of {enum.width} bits{other}.")
        bits = whole_bits(enum.width)
        return EnumPlan(
            name,
            f"uint{bits}_t",
            f"{name}_get",
            f"{name}_put",
            f"{name}{'_numbers' if style.plain else 'Numbers'}",
            Cpp.remark(said),
            tuple(rows),
            member_numbers(enum),
        )

    def _bits(self, bits: ValueType) -> BitsPlan:
        style = self.style
        name = style.typedef(bits.name, _BITS)
        table = f"{name}{'_fields' if style.plain else 'Fields'}"
        spelled = members(field_names(bits), style.reserved | {name, *style.scope.taken})
        fields, facts = [], []
        for one in bits.fields:
            quantity, width = Quantity.of(one), one.high - one.low + 1
            unit = f", in {one.unit}" if one.unit else ""
            said = sentences(one.documentation, f"Bits {one.high} to {one.low}{unit}.")
            fields.append(FieldPlan(spelled[one.name], self.of(quantity, width), one.low, Cpp.remark(said)))
            facts.append(field_value(f"{bits.name}.{one.name}", one, self.table_of(one.type)))
        said = sentences(bits.documentation, f"The packed value `{bits.name}` of {bits.width} bits.")
        return BitsPlan(
            name, f"{name}_get", f"{name}_put", table, Cpp.remark(said), tuple(fields), tuple(facts)
        )
