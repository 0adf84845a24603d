# SPDX-License-Identifier: BSD-3-Clause
"""A value of the spec as a number of an observation or of an action."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.layer4_data import Value

_NUMBERS = ("int", "uint", "fixed", "ufixed", "float", "bool")


def is_number(value: Value[Any]) -> bool:
    """Can it be a number of a space? Enumerations cannot: no member is more than another."""
    return value.quantity.type.kind in _NUMBERS


@dataclass(frozen=True)
class Channel:
    """A value, and the least and most that it can be, in the unit of the spec."""

    path: str
    value: Value[Any]
    low: float
    high: float
    saturates: bool

    @classmethod
    def of(cls, value: Value[Any], *, bounded: bool) -> Channel:
        """Return the channel of a value. With `bounded` it needs limits, as an action does."""
        quantity, codec = value.quantity, value.codec
        kind = quantity.type.kind
        if kind == "bool":
            low, high = 0.0, 1.0
        elif kind == "float":
            low, high = -float("inf"), float("inf")
        else:
            ends = sorted(float(codec.decode(number & codec.mask)) for number in (codec.low, codec.high))
            low, high = ends[0], ends[1]
        if quantity.minimum is not None:
            low = max(low, float(quantity.minimum))
        if quantity.maximum is not None:
            high = min(high, float(quantity.maximum))
        if bounded and not (abs(low) < float("inf") and abs(high) < float("inf")):
            raise UnityLinkError(f"{value.path} has no limits to learn in; give it MIN and MAX in the spec")
        return cls(value.path, value, low, high, quantity.overflow == "saturate")

    def taken(self, number: float) -> tuple[Any, bool]:
        """Return what is written for a number of an action, and whether a limit was put in its place.

        Raises ValueRangeError if it is no number, or if it is beyond the limits and the spec does not say
        `OVERFLOW=saturate`.
        """
        if math.isnan(number):
            raise ValueRangeError(f"{self.path}: the action is not a number")
        unit = f" {self.value.unit}" if self.value.unit else ""
        if not self.low <= number <= self.high:
            if not self.saturates:
                raise ValueRangeError(
                    f"{self.path}: the action {number:g} is not in {self.low:g} to {self.high:g}{unit}; "
                    "clip it, or give the value OVERFLOW=saturate"
                )
            return self._written(min(max(number, self.low), self.high)), True
        return self._written(number), False

    def _written(self, number: float) -> Any:
        kind = self.value.quantity.type.kind
        if kind == "bool":
            return number >= 0.5
        return number if self.value.quantity.scaled or kind == "float" else round(number)
