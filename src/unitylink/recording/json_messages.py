# SPDX-License-Identifier: BSD-3-Clause
"""Samples as JSON, in recordings and live streams: `j1.cpos` is the field `cpos` of the object `j1`."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from operator import itemgetter
from typing import Any

_NUMBERS = frozenset((int, float))
_encode = json.JSONEncoder(separators=(",", ":")).encode
_STEP = re.compile(r"[^.\[\]]+")


def steps(path: str) -> list[str]:
    """Return the names on the way to an item.

    >>> steps("leg[2].knee.angle")
    ['leg', '2', 'knee', 'angle']
    """
    return _STEP.findall(path)


class JsonMessage:
    """Makes the JSON of samples that have the same paths. Only the values are filled in.

    >>> JsonMessage(["j1.cpos", "j1.spd", "on"]).text((0.5, float("nan"), True))
    '{"j1":{"cpos":0.5,"spd":null},"on":true}'
    """

    def __init__(self, paths: tuple[str, ...] | list[str]) -> None:
        order: list[int] = []

        def text(node: Any) -> str:
            if isinstance(node, dict):
                return "{" + ",".join(f'"{key}":{text(inner)}' for key, inner in node.items()) + "}"
            order.append(node)
            return "%s"

        # paths consist of names and numbers, so they contain no %
        self._template = text(_nested({path: place for place, path in enumerate(paths)}))
        self._in_order = itemgetter(*order)

    def text(self, values: tuple[Any, ...]) -> str:
        """Return the JSON of one sample. `values` are in the order of the paths."""
        if not _NUMBERS.issuperset(map(type, values)) or not all(map(math.isfinite, values)):
            values = tuple(map(_json, values))  # other numbers need no change for JSON
        text: str = self._template % self._in_order(values)
        return text


def schema_of(values: Mapping[str, Any], units: Mapping[str, str]) -> dict[str, Any]:
    """Return the JSON schema of samples like `values`, by path. `units` by path are in the descriptions.

    >>> schema_of({"j1.cpos": 0.5}, {"j1.cpos": "rad"})["properties"]["j1"]["properties"]
    {'cpos': {'type': 'number', 'description': 'in rad'}}
    """

    def kind(value: Any) -> dict[str, Any]:
        if isinstance(value, _Described):
            return {**kind(value.value), "description": f"in {value.unit}"}
        if isinstance(value, dict):
            return {"type": "object", "properties": {key: kind(inner) for key, inner in value.items()}}
        if isinstance(value, bool):
            return {"type": "boolean"}
        return {"type": "string" if isinstance(value, str) else "number"}

    described = {
        path: _Described(value, units[path]) if units.get(path) else value for path, value in values.items()
    }
    return kind(_nested(described))


@dataclass(frozen=True)
class _Described:
    """A value and its unit, for a schema."""

    value: Any
    unit: str


def _nested(values: dict[str, Any]) -> dict[str, Any]:
    """Return `{"j1": {"cpos": 3}}` for `{"j1.cpos": 3}`."""
    tree: dict[str, Any] = {}
    for path, value in values.items():
        *above, last = steps(path)
        branch = tree
        for step in above:
            branch = branch.setdefault(step, {})
        branch[last] = value
    return tree


def _json(value: Any) -> str:
    if isinstance(value, float):
        return repr(value) if math.isfinite(value) else "null"
    return _encode(value)
