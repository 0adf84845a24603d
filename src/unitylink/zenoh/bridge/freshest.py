# SPDX-License-Identifier: BSD-3-Clause
"""Which set-point is to be written: the newest of each key, and none that is too old. No I/O, no clock."""

from __future__ import annotations

from ..messages import TTL_MAX_NS, SetPoint

KEYS_MAX = 4096


class Freshest:
    """Takes set-points in any order, and gives out those that are due. Times are those of the bridge.

    >>> freshest = Freshest()
    >>> for number in (1, 3, 2):
    ...     print(repr(freshest.offer(SetPoint("j1", 7, number, 100, b""), now_ns=50)))
    ''
    ''
    'overtaken'
    >>> [point.sequence for point in freshest.take(now_ns=60)]
    [3]
    """

    def __init__(self) -> None:
        self._waiting: dict[str, SetPoint] = {}
        self._newest: dict[tuple[int, str], int] = {}  # by visit and key
        self.replaced = 0  # set-points that a newer one has replaced before they were written
        self.late = 0  # set-points whose time was over before they were written

    def offer(self, point: SetPoint, now_ns: int) -> str:
        """Take a set-point. Return "", or why it is not taken."""
        if point.deadline_ns <= now_ns:
            return "late"
        if point.deadline_ns > now_ns + TTL_MAX_NS:
            return "time to live"
        place = (point.visit, point.key)
        if point.sequence <= self._newest.get(place, -1):
            return "overtaken"
        if len(self._newest) >= KEYS_MAX and place not in self._newest:
            return "full"
        self._newest[place] = point.sequence
        if self._waiting.pop(point.key, None) is not None:  # it goes to the end: the order is that of arrival
            self.replaced += 1
        self._waiting[point.key] = point
        return ""

    def take(self, now_ns: int) -> list[SetPoint]:
        """Return what waits and is not too old, in the order of its arrival."""
        waiting, self._waiting = self._waiting, {}
        due = [point for point in waiting.values() if point.deadline_ns > now_ns]
        self.late += len(waiting) - len(due)
        return due

    def forget(self, visit: int) -> None:
        """Drop what a client has sent that is gone."""
        self._newest = {place: number for place, number in self._newest.items() if place[0] != visit}
        self._waiting = {key: point for key, point in self._waiting.items() if point.visit != visit}
