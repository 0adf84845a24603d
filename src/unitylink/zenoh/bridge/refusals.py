# SPDX-License-Identifier: BSD-3-Clause
"""What a bridge has refused: counted by reason, with the newest of each by name. No I/O, no clock."""

from __future__ import annotations

import threading

TEXT_MAX = 300
REASONS = (
    "malformed",  # the bytes are no message
    "wildcard",  # a key that names more than one item
    "unknown",  # an item, or a visit, that there is none of
    "spec",  # the sender was made from another spec
    "value",  # NaN, out of range, or no such value
    "late",  # it came after its deadline
    "time to live",  # a deadline so far away that it is none
    "overtaken",  # a newer set-point of this sender had come before
    "access",  # the rights, or a lease
    "full",  # too many at the same time
    "board",  # the board is away, or refuses it
)


class Refusals:
    """Counters for every reason, and the last text of each.

    >>> refusals = Refusals()
    >>> refusals.add("value", "j1.goal: NaN")
    >>> refusals.report()
    {'value': {'count': 1, 'last': 'j1.goal: NaN'}}
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._told: dict[str, tuple[int, str]] = {}

    def add(self, reason: str, text: str) -> None:
        """Count one."""
        if reason not in REASONS:
            raise ValueError(f"{reason!r} is no reason of {REASONS}")
        with self._lock:
            count, _ = self._told.get(reason, (0, ""))
            self._told[reason] = (count + 1, text[:TEXT_MAX])

    def report(self) -> dict[str, dict[str, int | str]]:
        """Return count and last text by reason."""
        with self._lock:
            return {reason: {"count": count, "last": last} for reason, (count, last) in self._told.items()}
