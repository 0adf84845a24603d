# SPDX-License-Identifier: BSD-3-Clause
"""What the page has to know of a robot before the first value comes: all of it from the spec."""

from __future__ import annotations

import math
from typing import Any

from unitylink.layer4_data import Node, Value
from unitylink.spec.model import Element, Instance
from unitylink.values import format_value

MOST_DIGITS = 9
EXACT_BITS = 53  # whole numbers of more bits are not exact in a browser, so they travel as text
VERBS = {"WRITE": "write", "READWRITE": "write", "PULSE": "pulse", "W1C": "clear"}


def describe(root: Instance, robot: Node) -> dict[str, Any]:
    """Return a description of the robot that can be written as JSON.

    `items` has one entry for each element, in the order of the spec. `parts` is the tree. It names items by
    their index. `groups` are the groups of the spec.
    """
    elements = list(root.walk())
    index = {element.path: number for number, element in enumerate(elements)}
    values = {value.path: value for value in robot}
    return {
        "robot": root.name,
        "items": [item(element, values[element.path]) for element in elements],
        "tree": _part(root, index),
        "groups": [
            {"path": group.path, "items": [index[element.path] for element in group.elements]}
            for group in _groups(root)
        ],
        "can_stop": any(element.safe is not None for element in elements),
    }


def item(element: Element, value: Value[Any]) -> dict[str, Any]:
    """Return the description of one element."""
    kind = element.type.kind
    publish = element.publish
    facts: dict[str, Any] = {
        "path": element.path,
        "name": element.name,
        "display": element.display,
        "note": element.documentation,
        "unit": element.unit,
        "kind": kind if kind in ("bool", "enum", "bits") else "number",
        "whole": value.codec.integer_sign is not None,
        "digits": _digits(value),
        "text": as_text(value),
        "verb": VERBS.get(element.access),
        "read": element.readable,
        "confirm": _question(element),
        "on_event": publish is not None and publish.trigger != "rate",
    }
    if element.type.enum is not None:
        facts["members"] = [[one.value, one.name] for one in element.type.enum.values]
    for name in ("minimum", "maximum", "initial", "safe"):
        given = getattr(element, name)
        facts[name] = None if given is None else value.codec.quantity.text(given) if kind == "bits" else given
    if facts["verb"] and kind not in ("enum", "bits", "bool"):
        facts["least"], facts["greatest"] = value.minimum, value.maximum
        if facts["text"]:  # as text, because a browser would round them
            facts["least"], facts["greatest"] = format_value(value.minimum), format_value(value.maximum)
    return facts


def as_text(value: Value[Any]) -> bool:
    """Return whether a browser cannot hold the value as a number, so that the page gets a text, too."""
    kind = value.quantity.type
    whole = value.codec.integer_sign is not None
    return kind.kind == "bits" or (whole and value.codec.width > EXACT_BITS)


def _digits(value: Value[Any]) -> int | None:
    """Return how many digits after the point one step of a scaled value needs, or None if it has no steps."""
    if not value.quantity.scaled or value.quantity.type.kind == "float":
        return None
    step = abs(value.quantity.scale) / (1 << value.quantity.type.fraction)
    return min(MOST_DIGITS, max(0, -math.floor(math.log10(step) + 1e-9)))


def _question(element: Element) -> str | None:
    """Return what a person is asked before a write: the spec says `@confirm("Open the gripper?")`."""
    for note in element.annotations:
        if note.name == "confirm":
            return str(note.values[0]) if note.values else f"Write {element.path}?"
    return None


def _part(instance: Instance, index: dict[str, int]) -> dict[str, Any]:
    return {
        "path": instance.path,
        "name": instance.name,
        "display": instance.display or instance.name,
        "note": instance.documentation,
        "items": [index[element.path] for element in instance.elements],
        "parts": [_part(below, index) for below in instance.instances],
    }


def _groups(instance: Instance) -> list[Any]:
    return [*instance.groups, *(group for below in instance.instances for group in _groups(below))]
