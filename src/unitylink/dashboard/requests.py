# SPDX-License-Identifier: BSD-3-Clause
"""The requests of the page as JSON texts: read with care, for anybody can send anything."""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from typing import Any

from unitylink.errors import ValueRangeError, shown

MOST_SERIES = 256  # of one viewer
REQUESTS_HZ, BURST = 100.0, 200  # of one viewer
STEP_MIN_S, STEP_MAX_S = 1e-4, 3600.0


@dataclass(frozen=True)
class Request:
    """A request: what to do, its number for the answer, and what else it says."""

    do: str
    number: int
    facts: dict[str, Any]

    def text(self, name: str) -> str:
        """Return a text of the request. Raises ValueRangeError if it is none."""
        given = self.facts.get(name)
        if not isinstance(given, str) or len(given) > 10_000:
            raise ValueRangeError(f"{self.do}: {name} is no text")
        return given

    def count(self, name: str) -> int:
        """Return a whole number of the request. Raises ValueRangeError if it is none."""
        given = self.facts.get(name)
        if not isinstance(given, int) or isinstance(given, bool):
            raise ValueRangeError(f"{self.do}: {name} is no whole number")
        return given

    def seconds(self, name: str, least: float, most: float) -> float:
        """Return a time of the request, in s. Raises ValueRangeError if it is not between the limits."""
        return seconds(f"{self.do}: {name}", self.facts.get(name), least, most)

    def series(self, items: int) -> list[tuple[int, float, float]]:
        """Return (item, step in s, begin in s) of each wanted series. `items` is how many items there are."""
        given = self.facts.get("series")
        if not isinstance(given, list) or len(given) > MOST_SERIES:
            raise ValueRangeError(f"{self.do}: series is no list of up to {MOST_SERIES}")
        found = []
        for one in given:
            if not isinstance(one, list) or len(one) != 3:
                raise ValueRangeError(f"{self.do}: {shown(one)} is no series [item, step_s, begin_s]")
            item, step_s, begin_s = one
            if not isinstance(item, int) or isinstance(item, bool) or not 0 <= item < items:
                raise ValueRangeError(f"{self.do}: there is no item {shown(item)}; there are {items}")
            step_s = seconds("step_s", step_s, STEP_MIN_S, STEP_MAX_S)
            found.append((item, step_s, seconds("begin_s", begin_s, -1e9, 1e9)))
        return found


def seconds(name: str, given: object, least: float, most: float) -> float:
    if not isinstance(given, (int, float)) or isinstance(given, bool) or not least <= given <= most:
        raise ValueRangeError(f"{name} is {shown(given)}; expected {least:g} to {most:g} s")
    return float(given)


def read(text: str) -> Request:
    """Return the request that a text is. Raises ValueRangeError if it is none.

    >>> read('{"do": "take", "id": 3, "part": "j1"}')
    Request(do='take', number=3, facts={'part': 'j1'})
    """
    try:
        data = json.loads(text, parse_constant=_refuse)
    except (ValueError, RecursionError):
        raise ValueRangeError("the request is no JSON") from None
    if not isinstance(data, dict):
        raise ValueRangeError("the request is no JSON object")
    do, number = data.pop("do", None), data.pop("id", 0)
    if not isinstance(do, str) or len(do) > 40:
        raise ValueRangeError("the request does not say what to do")
    if not isinstance(number, int) or isinstance(number, bool) or not 0 <= number < 2**53:
        raise ValueRangeError(f"{do}: id is no whole number")
    return Request(do, number, data)


def _refuse(_: str) -> float:
    raise ValueError("NaN and Infinity are no JSON")


def plain(number: float) -> float | None:
    """Return a number for JSON, which has no NaN and no infinity."""
    return number if math.isfinite(number) else None
