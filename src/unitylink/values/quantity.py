# SPDX-License-Identifier: BSD-3-Clause
"""The meaning of a value of the gateware: type, scale, unit and limits."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from unitylink.spec.types import UINT32, Number, ValueType


@dataclass(frozen=True)
class Quantity:
    """The meaning of a value: engineering value = raw number * `scale` + `offset`, in `unit`.

    `minimum`, `maximum`, `initial` and `safe` are engineering values, or None. `overflow` says what a write
    beyond the limits does: "error", or "saturate" (the limit is written).

    >>> Quantity(ValueType("int", 16), scale=0.001, unit="rad").text(1.5)
    '1.5 rad'
    """

    type: ValueType = UINT32
    scale: Number = 1
    offset: Number = 0
    unit: str = ""
    minimum: Number | None = None
    maximum: Number | None = None
    overflow: str = "error"
    initial: Any = None
    safe: Any = None

    @classmethod
    def of(cls, element: Any) -> Quantity:
        """Return the quantity of a model element, or of a field."""
        names = ("type", "scale", "offset", "unit", "minimum", "maximum", "overflow", "initial", "safe")
        given = {name: getattr(element, name) for name in names if hasattr(element, name)}
        return cls(**given)

    @property
    def scaled(self) -> bool:
        """Return whether values are floats made from whole raw numbers."""
        return self.type.kind in ("fixed", "ufixed") or self.scale != 1 or self.offset != 0

    def asks_for_frames(self, access: str) -> str:
        """Return why a value is refused on a link that has fallen back to the classic protocol, or "".

        >>> Quantity(safe=0).asks_for_frames("WRITE")
        'has a SAFE value'
        """
        if access == "PULSE":
            return "is a PULSE"
        return "has a SAFE value" if self.safe is not None else ""

    def text(self, value: Any) -> str:
        """Return the value for people, with its unit."""
        shown = format_value(value)
        return f"{shown} {self.unit}" if self.unit else shown


def format_value(value: Any) -> str:
    """Return a value as text for people: floats with the digits that matter, members and records by name.

    >>> format_value(0.1 + 0.2), format_value(-12), format_value(True)
    ('0.3', '-12', 'true')
    """
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, float):
        return f"{value:.9g}"
    if isinstance(value, int):
        name = getattr(value, "name", None)
        return name if isinstance(name, str) else str(value)
    if hasattr(value, "__dataclass_fields__"):
        shown = (f"{name}={format_value(getattr(value, name))}" for name in value.__dataclass_fields__)
        return "{" + ", ".join(shown) + "}"
    return str(value)
