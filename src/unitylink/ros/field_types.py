# SPDX-License-Identifier: BSD-3-Clause
"""Types of UL-spec as ROS types, and the comments of fields."""

from __future__ import annotations

from unitylink.spec.model import Element
from unitylink.spec.types import Field as BitField
from unitylink.spec.types import ValueType
from unitylink.values import Quantity, format_value

_WIDTHS = (8, 16, 32, 64)

# The scalars of std_msgs by primitive.
SCALARS = {
    "bool": "Bool",
    "float32": "Float32",
    "float64": "Float64",
    **{f"int{bits}": f"Int{bits}" for bits in _WIDTHS},
    **{f"uint{bits}": f"UInt{bits}" for bits in _WIDTHS},
}


def primitive(quantity: Quantity) -> str:
    """Return the smallest ROS primitive that holds a value in its unit.

    For packed bits it holds the raw number.

    >>> from unitylink.spec.types import ValueType
    >>> primitive(Quantity(ValueType("int", 12))), primitive(Quantity(ValueType("int", 12), scale=0.1))
    ('int16', 'float64')
    """
    kind = quantity.type
    if kind.kind == "bool":
        return "bool"
    if kind.kind == "float":
        return "float32" if kind.width <= 32 and not quantity.scaled else "float64"
    if quantity.scaled:
        return "float64"
    return whole(kind)


def whole(kind: ValueType) -> str:
    """Return the primitive of a type's whole number, scaled or not."""
    width = next(bits for bits in _WIDTHS if kind.width <= bits)
    return f"{'int' if kind.signed else 'uint'}{width}"


def comment(item: Element | BitField) -> str:
    """Return the comment of a field: unit, limits, documentation, on one line."""
    parts = [item.unit] if item.unit else []
    if item.minimum is not None or item.maximum is not None:
        ends = [format_value(end) if end is not None else "" for end in (item.minimum, item.maximum)]
        parts.append(f"{ends[0]} to {ends[1]}".strip())
    said = " ".join(item.documentation.split())
    text = ", ".join(parts) + (f": {said}" if said and parts else said)
    return "".join(c if c.isprintable() else " " for c in text)
