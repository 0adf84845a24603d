# SPDX-License-Identifier: BSD-3-Clause
"""One register as UL-spec: a type, an access word, properties."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from systemrdl.node import FieldNode, RegNode
from systemrdl.rdltypes.builtin_enums import OnWriteType

from ..failure import Failure
from ..spec_names import Names
from .comments import documentation

MAX_BITS = 64


@dataclass
class Types:
    """The types declared so far. Equal types are declared once."""

    names: Names
    declared: dict[str, str]  # the declaration without its name -> name
    texts: list[str]
    notes: list[str]  # what UL-spec could not express

    def declare(self, word: str, wanted: str, body: str) -> str:
        """Return the name of a type with this body, declaring it if it is new."""
        key = f"{word}{body}"
        if key not in self.declared:
            self.declared[key] = name = self.names.unique(wanted)
            self.texts.append(f"{word} {name}: {body}")
        return self.declared[key]


def register(reg: RegNode, types: Types) -> str:
    """Return "type ACCESS(properties)" of a register."""
    width = reg.get_property("regwidth")
    if width > MAX_BITS:
        raise Failure(f"{reg.get_path()} has {width} bits; a value of UL-spec has at most {MAX_BITS}")
    fields = list(reg.fields())
    whole = len(fields) == 1 and fields[0].low == 0
    kind = _field_type(fields[0], types) if whole else _bits(reg, fields, width, types)
    access = _access(reg, fields, types)
    initial = _initial(fields, kind) if access in ("WRITE", "READWRITE") else None
    properties = [] if initial is None else [f"INITIAL={initial}"]
    name = reg.get_property("name", default="")
    if name and name != reg.inst_name:
        text = name.replace("\\", "\\\\").replace('"', '\\"').replace("{", "(").replace("}", ")")
        properties.insert(0, f'ID="{" ".join(text.split())[:200]}"')
    return f"{kind} {access}({', '.join(properties)})"


def _bits(reg: RegNode, fields: list[FieldNode], width: int, types: Types) -> str:
    names = Names()
    lines = []
    for field in fields:
        place = f"{field.high}" if field.width == 1 else f"{field.high}..{field.low}"
        lines.append(
            documentation(field, "   ")
            + f"   {names.unique(field.inst_name)}: {_field_type(field, types)} @ {place};\n"
        )
    return types.declare("bits", reg.type_name or reg.inst_name, f"u{width} {{\n{''.join(lines)}}}\n")


def _field_type(field: FieldNode, types: Types) -> str:
    if field.width > MAX_BITS:
        raise Failure(f"{field.get_path()} has {field.width} bits; a value of UL-spec has at most {MAX_BITS}")
    encode = field.get_property("encode", default=None)
    if encode is not None:
        names = Names()
        values = []
        seen: set[int] = set()
        for member in encode:
            if int(member.value) not in seen:  # the first name of a number is kept
                text = documentation(member, "   ", member.rdl_desc)
                values.append(f"{text}   {names.unique(member.name)} = {int(member.value)};\n")
                seen.add(int(member.value))
        body = f"u{field.width} {{\n{''.join(values)}}}\n"
        # In SystemRDL, other numbers may come, too.
        return types.declare("open enum", encode.type_name, body)
    signed = bool(_own(field, "is_signed"))
    fraction, whole = _own(field, "fracwidth"), _own(field, "intwidth")
    if fraction is not None or whole is not None:
        fraction = fraction if fraction is not None else field.width - whole
        if 0 <= fraction <= field.width:
            return f"{'' if signed else 'u'}fixed({field.width - fraction},{fraction})"
        types.notes.append(f"{field.get_path()}: a fraction of {fraction} bits in {field.width} was left out")
    if field.width == 1 and not signed:
        return "bool"
    return f"{'i' if signed else 'u'}{field.width}"


def _own(field: FieldNode, name: str) -> Any:
    """Return a property that the file itself may have declared, as PeakRDL's users do for fixed point."""
    try:
        return field.get_property(name, default=None)
    except LookupError:
        return None


def _access(reg: RegNode, fields: list[FieldNode], types: Types) -> str:
    readable = any(field.is_sw_readable for field in fields)
    writable = [field for field in fields if field.is_sw_writable]
    path = reg.get_path()
    if readable and any(field.get_property("onread") is not None for field in fields):
        if writable:
            types.notes.append(f"{path}: reading has a side effect, so it is READCLEAR; it cannot be written")
        return "READCLEAR"
    if not writable:
        return "READ"
    effects = {field.get_property("onwrite") for field in writable}
    if effects == {OnWriteType.woclr}:
        return "W1C"
    if effects != {None}:
        words = ", ".join(sorted(effect.name for effect in effects if effect is not None))
        types.notes.append(f"{path}: writes with the effects {words} are written like any other")
    if not readable:
        pulses = all(field.get_property("singlepulse") for field in writable)
        return "PULSE" if pulses else "WRITE"
    fixed = [field.inst_name for field in fields if not field.is_sw_writable]
    if fixed:
        types.notes.append(f"{path}: {', '.join(fixed)} cannot be written, the register is READWRITE")
    return "READWRITE"


def _initial(fields: list[FieldNode], kind: str) -> str | None:
    raw = 0
    for field in fields:
        reset = field.get_property("reset", default=None)
        if not isinstance(reset, int):
            if field.is_sw_writable:
                return None
            reset = 0
        raw |= reset << field.low
    if len(fields) == 1 and fields[0].low == 0:
        if "fixed" in kind:
            return None  # the default is an engineering value, but the reset is a raw one
        if kind == "bool":
            return str(raw)
        if kind[0] == "i" and kind[1:].isdigit() and raw >> (fields[0].width - 1):
            return str(raw - (1 << fields[0].width))
    return str(raw) if raw < 10 else f"0x{raw:X}"
