# SPDX-License-Identifier: BSD-3-Clause
"""Enumerations and packed values as types of C, C++ and Rust, and values as literals."""

from __future__ import annotations

from typing import Any

from unitylink.spec.model import Spec
from unitylink.spec.types import EnumType, ValueType
from unitylink.values import Codec, Quantity, field_names

from ..quoting import Code
from .dialect import C
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
        self.dialect, self.code = style.dialect, style.dialect.code
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
        code, rust = self.code, self.dialect.rust
        if read_as in ("SCALED", "REAL"):
            return TypeName(code("f64" if rust else "double"), "ul_get_double", "ul_put_double")
        if read_as == "BOOL":
            return TypeName(code("bool"), "ul_get_bool", "ul_put_bool")
        if read_as == "ENUM" and kind.enum is not None:
            plan = self.enums[kind.enum.name]
            return TypeName(code.of("{}", plan.name), plan.get, plan.put)
        if read_as == "BITS":
            packed = self.bits[kind.name]
            return TypeName(code.of("{}", packed.name), packed.get, packed.put)
        name, short = self._whole(width, signed=kind.signed)
        return TypeName(name, f"ul_get_{short}", f"ul_put_{short}")

    def _whole(self, width: int, *, signed: bool) -> tuple[Code, str]:
        return self.dialect.whole(whole_bits(width), signed=signed)

    def table_of(self, kind: ValueType) -> Code:
        """Return the name of the table of an enumeration's numbers, or a null pointer."""
        if kind.enum is None:
            return self.dialect.null
        return self.code.of("{}", self.enums[kind.enum.name].numbers)

    def literal(self, quantity: Quantity, width: int, value: Any) -> Code:
        """Return a value of the spec as a literal of its type."""
        codec = Codec("initial", quantity, width)
        return self._literal(quantity, width, codec.encode(value))

    def _literal(self, quantity: Quantity, width: int, raw: int) -> Code:
        kind, code = quantity.type, self.code
        read_as = kind_of(kind, quantity)
        if read_as == "BITS":
            fields = []
            for one, plan in zip(kind.fields, self.bits[kind.name].fields, strict=True):
                size = one.high - one.low + 1
                told = self._literal(Quantity.of(one), size, raw >> one.low & (1 << size) - 1)
                fields.append(code.of("{}: {}", plan.name, told) if self.dialect.rust else told)
            name = self.of(quantity, width).name if self.dialect.rust else code("")
            return code.of("{}{{{}}}", name, code(", ").join(fields))
        if read_as == "BOOL":
            return code("true") if raw & 1 else code("false")
        if read_as == "ENUM" and kind.enum is not None:
            return self._member(self.enums[kind.enum.name], raw)
        number = Codec("initial", quantity, width).decode(raw)
        if read_as in ("SCALED", "REAL"):
            return code.of("{}", float(number))
        if number == -(1 << 63):
            return code("i64::MIN" if self.dialect.rust else "INT64_MIN")
        return code.of("{}", int(number)) if kind.signed else self.dialect.unsigned(int(number))

    def _member(self, plan: EnumPlan, raw: int) -> Code:
        number = self.dialect.unsigned(raw)
        if not self.dialect.rust:
            return number if self.style.plain else self.code.of("{}{{{}}}", plan.name, number)
        if plan.open:
            return self.code.of("{}({})", plan.name, number)
        name = next(member.name for member in plan.members if member.value == raw)
        return self.code.of("{}::{}", plan.name, name)

    def _enum(self, enum: EnumType) -> EnumPlan:
        style = self.style
        name = style.typedef(enum.name, _ENUM)
        names = members([item.name for item in enum.values], self.dialect.keywords)
        if style.plain:
            names = {
                item.name: style.scope.claim(f"{name.removesuffix('_t')}_{item.name}".upper())
                for item in enum.values
            }
        rows = [
            EnumMember(names[item.name], item.value, self.code.remark(item.documentation))
            for item in enum.values
        ]
        other = "; other numbers stay numbers" if enum.open else ""
        said = sentences(enum.documentation, f"The enumeration `{enum.name}` of {enum.width} bits{other}.")
        base, _ = C.whole(whole_bits(enum.width), signed=False)
        return EnumPlan(
            name,
            self._whole(enum.width, signed=False)[0] if self.dialect.rust else base,
            f"{name}_get",
            f"{name}_put",
            f"{name}{'_numbers' if style.plain else 'Numbers'}",
            self.code.remark(said),
            tuple(rows),
            member_numbers(enum, self.dialect),
            enum.open,
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
            fields.append(
                FieldPlan(spelled[one.name], self.of(quantity, width), one.low, self.code.remark(said))
            )
            facts.append(field_value(f"{bits.name}.{one.name}", one, self.table_of(one.type), self.dialect))
        said = sentences(bits.documentation, f"The packed value `{bits.name}` of {bits.width} bits.")
        return BitsPlan(
            name, f"{name}_get", f"{name}_put", table, self.code.remark(said), tuple(fields), tuple(facts)
        )
