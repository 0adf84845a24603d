# SPDX-License-Identifier: BSD-3-Clause
"""Similar names: find the one that was probably meant."""

from __future__ import annotations

import re
from collections.abc import Iterable

# Words of other languages -> the words for the same things in UL-spec.
_FOREIGN = {
    **dict.fromkeys(("r", "ro", "in", "input"), "READ"),
    **dict.fromkeys(("w", "wo", "out", "output"), "WRITE"),
    **dict.fromkeys(("rw", "r_w", "inout"), "READWRITE"),
    **dict.fromkeys(("woclr", "rw1c"), "W1C"),
    **dict.fromkeys(("rclr", "rc"), "READCLEAR"),
    **dict.fromkeys(("on", "yes", "high", "enabled"), "true"),
    **dict.fromkeys(("off", "no", "low", "disabled"), "false"),
    **dict.fromkeys(("wpulse", "singlepulse", "strobe"), "PULSE"),
}
_PARTS = re.compile(r"[_.]")
# the most that are compared for one name, which limits the time for a spec full of mistakes
_CANDIDATES = 500


def distance(a: str, b: str, limit: int) -> int:
    """Return how many characters differ (inserted, deleted, replaced, swapped). It counts up to `limit` + 1.

    >>> distance("jiont", "joint", 2)
    1
    """
    if abs(len(a) - len(b)) > limit:
        return limit + 1
    before: list[int] = []
    row = list(range(len(b) + 1))
    for i, ca in enumerate(a, 1):
        previous, row = row, [i]
        for j, cb in enumerate(b, 1):
            cost = min(row[j - 1] + 1, previous[j] + 1, previous[j - 1] + (ca != cb))
            if i > 1 and j > 1 and ca == b[j - 2] and a[i - 2] == cb:
                cost = min(cost, before[j - 2] + 1)
            row.append(cost)
        if min(row) > limit:
            return limit + 1
        before = previous
    return min(row[-1], limit + 1)


def nearest(name: str, candidates: Iterable[str]) -> str | None:
    """Return the candidate most similar to `name`, or None. A difference only in case is the smallest.

    The word for the same thing in another language is similar, too. If nothing is similar, a candidate with
    `name` as one of its parts is taken.

    >>> nearest("jiont", ["leg", "joint"]), nearest("rw", ["READ", "READWRITE"])
    ('joint', 'READWRITE')
    >>> nearest("encoder", ["pwm", "quadrature_encoder"])
    'quadrature_encoder'
    """
    limit = 1 if len(name) < 4 else 2 if len(name) < 9 else 3
    folded = name.lower()
    foreign = _FOREIGN.get(folded)
    best: str | None = None
    holder: str | None = None
    for count, candidate in enumerate(candidates):
        if count == _CANDIDATES:
            break
        if candidate == name:
            continue
        if candidate == foreign or candidate.lower() == folded:
            return candidate
        if min(len(name), len(candidate)) <= 1:
            continue
        if holder is None and len(name) > 2 and folded in _PARTS.split(candidate.lower()):
            holder = candidate
        found = distance(folded, candidate.lower(), limit)
        if found <= limit and found < len(candidate):
            best, limit = candidate, found - 1
    return best or holder
