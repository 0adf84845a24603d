# SPDX-License-Identifier: BSD-3-Clause
"""Puts samples of different sources into the order of their times. To do so, it holds them back."""

from __future__ import annotations

import heapq
from typing import Generic, TypeVar

T = TypeVar("T")


class ReorderBuffer(Generic[T]):
    """Hands things out in the order of their times, `hold_s` after each time.

    With 0 it hands them out at once, in the order in which they come.

    >>> held = ReorderBuffer[str](hold_s=0.2)
    >>> held.put(1.01, "later"), held.put(1.0, "sooner"), held.take(now_s=1.1)
    (True, True, None)
    >>> held.take(now_s=1.2), held.due_s(now_s=1.2) > 0, held.take_last()
    ('sooner', True, 'later')
    """

    def __init__(self, hold_s: float) -> None:
        self.hold_s = hold_s
        self._heap: list[tuple[float, int, T]] = []  # sorted by time, then by arrival
        self._came = 0
        self._given_s = float("-inf")

    def put(self, time_s: float, thing: T) -> bool:
        """Take a thing. The result is False if it comes too late for its place. Then it is not kept."""
        if self.hold_s == 0.0:
            time_s = 0.0
        elif time_s < self._given_s:
            return False
        self._came += 1
        heapq.heappush(self._heap, (time_s, self._came, thing))
        return True

    def due_s(self, now_s: float) -> float | None:
        """Return the seconds until there is something to take. Return None if nothing is held."""
        if not self._heap:
            return None
        return self._heap[0][0] + self.hold_s - now_s if self.hold_s else 0.0

    def take(self, now_s: float) -> T | None:
        """Return the oldest thing if it has been held for long enough."""
        due_s = self.due_s(now_s)
        return None if due_s is None or due_s > 0 else self.take_last()

    def take_last(self) -> T | None:
        """Return the oldest thing, however long it has been held."""
        if not self._heap:
            return None
        self._given_s, _, thing = heapq.heappop(self._heap)
        return thing
