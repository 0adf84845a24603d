# SPDX-License-Identifier: BSD-3-Clause
"""Reads and writes by name, for the services."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from unitylink.errors import ValueRangeError
from unitylink.layer4_data import ClearValue, Node, PulseValue, ReadValue, Value, ValueGroup, WriteValue


def read_values(tree: Node, names: Sequence[str], values: list[float], texts: list[str]) -> str:
    """Append each value as a number and as text with its unit. The number of packed bits is the raw one."""
    found = [(_named(tree, name), name) for name in names]
    for value, name in found:
        if not isinstance(value, ReadValue):
            raise ValueRangeError(f"{name} is a {value.access} and cannot be read")
        number = value.read()
        texts.append(value.quantity.text(getattr(number, "name", number)))
        values.append(float(value.codec.encode(number) if value.quantity.type.kind == "bits" else number))
    return ""


def write_values(tree: Node, names: Sequence[str], values: Sequence[float]) -> str:
    """Write WRITEs together, then PULSEs and W1Cs one by one. All are checked first."""
    if len(names) != len(values) or not names:
        raise ValueRangeError(f"{len(names)} names and {len(values)} values; nothing was written")
    writes: dict[str, Any] = {}
    strobes: list[tuple[PulseValue[Any] | ClearValue[Any], Any]] = []
    for name, given in zip(names, values, strict=True):
        value = _named(tree, name)
        number = _number(value, given)
        value.codec.encode(number)
        if isinstance(value, WriteValue):
            writes[name] = number
        elif isinstance(value, (PulseValue, ClearValue)):
            strobes.append((value, number))
        else:
            raise ValueRangeError(f"{name} is a {value.access} and cannot be written")
    if writes:
        ValueGroup([value for value in tree if value.path in writes]).write(writes)
    for strobe, number in strobes:
        if isinstance(strobe, PulseValue):
            strobe.pulse(number)
        else:
            strobe.clear(number)
    return f"written: {', '.join(names)}"


def _named(tree: Node, name: str) -> Value[Any]:
    try:
        value = tree[name]
    except KeyError as error:
        raise ValueRangeError(str(error.args[0])) from None
    if not isinstance(value, Value):
        raise ValueRangeError(f"{name} is not a value; the values are {', '.join(v.path for v in tree)}")
    return value


def _number(value: Value[Any], given: float) -> Any:
    """A service carries only float64. Whole numbers of the spec must be whole here too."""
    real = value.quantity.scaled or value.quantity.type.kind == "float"
    if real:
        return given
    if not math.isfinite(given) or given != int(given):
        raise ValueRangeError(f"{value.path}: {given} is not a whole number; nothing was written")
    return int(given)
