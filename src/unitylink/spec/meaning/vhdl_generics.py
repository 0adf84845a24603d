# SPDX-License-Identifier: BSD-3-Clause
"""The limits of an entity's generics, as its VHDL declares them.

So a component's limits stand once, in its VHDL, and a spec that breaks one is told before anything is built.
Limits that are no plain numbers are left to the tools that elaborate the VHDL.
"""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path

from ..source import MAX_BYTES
from ..text.imports import component_vhdl

_COMMENT = re.compile(r'("[^"\n]*")|--[^\n]*')
_GENERIC = re.compile(
    r"\b(?P<names>\w+(?:\s*,\s*\w+)*)\s*:\s*(?:in\s+)?(?P<type>positive|natural|integer)"
    r"(?:\s+range\s+(?P<low>-?\d[\d_]*)\s+to\s+(?P<high>-?\d[\d_]*))?\s*(?::=|;|\))",
    re.ASCII | re.IGNORECASE,
)
_END = re.compile(r"\b(?:port|end)\b", re.IGNORECASE)
_MOST = 20_000  # characters of an entity's generics
_LEAST = {"positive": 1, "natural": 0, "integer": -(1 << 31)}


def limits_of(entity: str, sources: list[str]) -> dict[str, tuple[int, int]]:
    """Return the least and the largest value of each generic that has limits, by its name in lower case.

    The VHDL is that of `sources`, or of the component library if there are none.

    >>> limits_of("pwm", [])["channels"]
    (1, 64)
    """
    paths = [Path(source) for source in sources] or [component_vhdl(entity)]
    found: dict[str, tuple[int, int]] = {}
    for path in paths:
        try:
            found |= _limits_in(path, path.stat().st_mtime_ns, entity)
        except OSError:  # there is no such file: `build` names it
            continue
    return found


@lru_cache(maxsize=256)
def _limits_in(path: Path, _changed: int, entity: str) -> dict[str, tuple[int, int]]:
    with path.open("rb") as file:
        text = file.read(MAX_BYTES).decode("utf-8", "replace")
    text = _COMMENT.sub(lambda found: found[1] or "", text)
    start = re.search(rf"\bentity\s+{re.escape(entity)}\s+is\b", text, re.IGNORECASE)
    head = _END.split(text[start.end() : start.end() + _MOST], maxsplit=1)[0] if start else ""
    found = {}
    for one in _GENERIC.finditer(head):
        low = int(one["low"]) if one["low"] else _LEAST[one["type"].lower()]
        high = int(one["high"]) if one["high"] else (1 << 31) - 1
        for name in one["names"].split(","):
            found[name.strip().lower()] = low, high
    return found
