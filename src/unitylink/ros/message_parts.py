# SPDX-License-Identifier: BSD-3-Clause
"""Makes messages that other packages define, from some of their fields. The other fields are 0 or empty."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from .plane import Plane
from .standard import STANDARD

# a function of the header and the values gives a message, or a field of one
Part = Callable[[Any, Sequence[Any]], Any]


def message_maker(
    plane: Plane, type_name: str, parts: Mapping[str, Part], constants: Mapping[str, Any]
) -> Part:
    """Return a function that makes a message.

    `parts` and `constants` have fields by their names, such as `twist.linear.x` and `covariance[0]`.
    """
    return _message(plane, type_name, "", parts, constants)


def _message(
    plane: Plane, type_name: str, prefix: str, parts: Mapping[str, Part], constants: Mapping[str, Any]
) -> Part:
    fields = STANDARD[type_name]
    make = plane.maker(type_name, [name for name, _ in fields])
    made = [_field(plane, kind, prefix + name, parts, constants) for name, kind in fields]
    return lambda header, numbers: make(*(part(header, numbers) for part in made))


def _field(
    plane: Plane, kind: str, place: str, parts: Mapping[str, Part], constants: Mapping[str, Any]
) -> Part:
    if kind == "std_msgs/Header":
        return lambda header, _: header
    if place in parts:
        return parts[place]
    if kind in STANDARD:
        return _message(plane, kind, f"{place}.", parts, constants)
    array = re.fullmatch(r"\w+\[(\d*)\]", kind)
    if array:
        values = [constants.get(f"{place}[{index}]", 0.0) for index in range(int(array[1] or 0))]
        return lambda header, _: list(values)
    empty: Any = {"string": "", "bool": False}.get(kind, 0.0 if kind.startswith("float") else 0)
    constant = type(empty)(constants.get(place, empty))
    return lambda header, _: constant
