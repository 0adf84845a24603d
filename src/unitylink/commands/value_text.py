# SPDX-License-Identifier: BSD-3-Clause
"""Values as text: numbers with units, names of enumerations, fields of packed values."""

from __future__ import annotations

import math
import re
from dataclasses import is_dataclass
from fractions import Fraction
from typing import Any

import click

from unitylink.spec.types import ValueType
from unitylink.values import Quantity, field_names, format_value, member_text

from .names import Item

_MOST_BITS = 64  # the most bits of a number that an item may have
_NUMBER = re.compile(
    r"([+-]?(?:0[xXoObB][0-9a-fA-F_]+|(?:\d[\d_]*\.?\d*|\.\d+)(?:[eE][+-]?\d+)?|inf|nan))\s*(.*)"
)
_TRUTH = {"true": True, "on": True, "1": True, "false": False, "off": False, "0": False}


def parse_value(text: str, item: Item) -> Any:
    """Return the value that `text` means for an item, in the item's unit.

    Numbers may have a unit (`30deg`). Enumerations are given by name or number. Packed values are given as
    `{ready=1, mode=run}` or as one number. Otherwise a usage error names the item and the allowed values.
    """
    if item.element is None:
        return _integer(text, item.name)
    return _parse(text, item.name, Quantity.of(item.element))


def _parse(text: str, name: str, quantity: Quantity) -> Any:
    kind = quantity.type
    if kind.kind == "bool":
        if text.lower() not in _TRUTH:
            raise click.UsageError(f"{name}: '{text}' is not a truth value; write {', '.join(_TRUTH)}")
        return _TRUTH[text.lower()]
    if kind.kind == "enum":
        return _integer(text, name) if text[:1].isdigit() else text  # the codec knows the names of members
    if kind.kind == "bits":
        return _fields(text, name, kind) if "=" in text else _integer(text, name)
    if kind.kind == "float" or quantity.scaled:
        return _real(text, name, quantity)
    match = _NUMBER.fullmatch(text)
    return _real(text, name, quantity) if match and match[2] else _integer(text, name)


def _fields(text: str, name: str, kind: ValueType) -> dict[str, Any]:
    types = {field.name: field for field in kind.fields}
    given: dict[str, Any] = {}
    for part in text.strip().removeprefix("{").removesuffix("}").split(","):
        field, _, value = (side.strip() for side in part.partition("="))
        if field not in types or field in given or not value:
            raise click.UsageError(
                f"{name}: '{part.strip()}' is not one of its fields, or is given twice; write "
                f"{{{', '.join(f'{known}=…' for known in types)}}}"
            )
        given[field] = _parse(value, f"{name}.{field}", Quantity.of(types[field]))
    return given


def _integer(text: str, name: str) -> int:
    try:
        return int(text, 0)
    except ValueError:
        raise click.UsageError(
            f"{name}: '{text}' is not an integer; write 30, -30, 0x1E or 0b11110"
        ) from None


def _real(text: str, name: str, quantity: Quantity) -> Any:
    match = _NUMBER.fullmatch(text.strip())
    if match is None:
        unit = f" or {30}{quantity.unit}" if quantity.unit else ""
        raise click.UsageError(f"{name}: '{text}' is not a number; write 1.5, -30, 2e-3{unit}")
    digits, unit = match[1], match[2].strip()
    whole = digits.lstrip("+-")[:2].lower() in ("0x", "0o", "0b")
    try:
        number: Any = int(digits, 0) if whole else float(digits)
    except ValueError:  # the text is 0_, or has more digits than any number
        raise click.UsageError(f"{name}: '{text}' is not a number") from None
    if not unit or unit == quantity.unit:
        return number if quantity.scaled or quantity.type.kind == "float" else _whole(number, text, name)
    converted = _converted(number, unit, name, quantity)
    return converted if quantity.scaled or quantity.type.kind == "float" else _whole(converted, text, name)


def _whole(number: float, text: str, name: str) -> int:
    if not math.isfinite(number) or number != round(number):
        raise click.UsageError(
            f"{name}: '{text}' is {number:g} , not an integer; the value counts whole steps"
        )
    return round(number)


def _converted(number: float, given: str, name: str, quantity: Quantity) -> float:
    from unitylink.spec.units import unit

    stored = f"it is in {quantity.unit}" if quantity.unit else "it has no unit"
    if isinstance(number, int) and number.bit_length() > _MOST_BITS:
        raise click.UsageError(f"{name}: this number is too large")
    source, target = unit(given), unit(quantity.unit) if quantity.unit else None
    if source is None or target is None or source.dimension != target.dimension or not math.isfinite(number):
        raise click.UsageError(f"{name}: '{number:g} {given}' cannot be converted; {stored}")
    return float(source.to(Fraction(number), target))


def shown(value: Any, quantity: Quantity) -> str:
    """Return a value for a table, without its unit."""
    kind = quantity.type
    if kind.enum is not None:
        return member_text(kind, value)
    if kind.kind == "bits" and is_dataclass(value):
        attributes = field_names(kind)
        parts = (f"{f.name}={shown(getattr(value, attributes[f.name]), Quantity.of(f))}" for f in kind.fields)
        return "{" + ", ".join(parts) + "}"
    return format_value(value)
