# SPDX-License-Identifier: BSD-3-Clause
"""Values for JSON."""

from __future__ import annotations

import math
import struct
from dataclasses import fields, is_dataclass
from enum import IntEnum
from typing import Any

from .classes import field_names
from .codec import member_text
from .quantity import Quantity

_SINGLE = 32  # bits


def plain(value: Any, quantity: Quantity) -> Any:
    """Return a value for JSON: members by name, packed values as objects, NaN and infinities as strings.

    An f32 has the digits from which it was made: 12.54, not 12.539999961853027.
    """
    kind = quantity.type
    if isinstance(value, IntEnum):
        return member_text(kind, value)
    if is_dataclass(value):
        names = {attribute: spec for spec, attribute in field_names(kind).items()}
        types = {field.name: field for field in kind.fields}
        return {
            names[one.name]: plain(getattr(value, one.name), Quantity.of(types[names[one.name]]))
            for one in fields(value)
        }
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if kind.kind == "float" and kind.width == _SINGLE and not quantity.scaled:
        return shortest_single(value)
    return value


def shortest_single(value: float) -> float:
    """Return the shortest decimal number that a float of 32 bits cannot tell from `value`.

    >>> shortest_single(12.539999961853027)
    12.54
    """
    texts = (f"{value:.{digits}g}" for digits in range(6, 9))
    wanted = struct.pack("f", value)
    return next((float(text) for text in texts if struct.pack("f", float(text)) == wanted), value)
