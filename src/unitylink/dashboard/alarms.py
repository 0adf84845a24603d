# SPDX-License-Identifier: BSD-3-Clause
"""Values beyond the limits of the spec: when, how far, and who has seen it."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from unitylink.errors import UnknownName, shown

from .requests import plain

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from unitylink.layer4_data import Value

    from .feed import Portion


@dataclass
class Alarm:
    """An item that is or was beyond one of its limits.

    `worst` is the value that was farthest beyond it. `begun_s` and `ended_s` are in s since 1970. `ended_s`
    is None while it lasts. `count` says how often it began. `seen_by` has acknowledged it.
    """

    item: int
    path: str
    above: bool
    limit: float
    worst: float
    begun_s: float
    ended_s: float | None = None
    count: int = 1
    seen_by: str = ""

    def told(self) -> dict[str, Any]:
        """Return it for JSON."""
        return {
            "item": self.item,
            "above": self.above,
            "limit": self.limit,
            "worst": plain(self.worst),
            "begun_s": round(self.begun_s, 3),
            "ended_s": self.ended_s and round(self.ended_s, 3),
            "count": self.count,
            "seen_by": self.seen_by,
        }


class Alarms:
    """Compares each sample with `MIN` and `MAX` of its item, so that no short excursion is missed.

    An alarm stays in the list until it is over and has been acknowledged.

    >>> alarms.take(portion); alarms.acknowledge("j1.angle", "ana")     # doctest: +SKIP
    """

    def __init__(self, values: Sequence[Value[Any]], note: Callable[[str, str], object]) -> None:
        """`note` tells all viewers of an event, by its kind and text."""
        self._note = note
        self._limits: dict[str, tuple[int, float, float]] = {}
        for number, value in enumerate(values):
            least, most = value.quantity.minimum, value.quantity.maximum
            if value.quantity.type.numeric and (least is not None or most is not None):
                low = -np.inf if least is None else float(least)
                self._limits[value.path] = number, low, np.inf if most is None else float(most)
        self._alarms: dict[tuple[str, bool], Alarm] = {}

    def all(self) -> list[Alarm]:
        """Return the alarms, those that nobody has acknowledged first, then by their time."""
        return sorted(self._alarms.values(), key=lambda one: (bool(one.seen_by), -one.begun_s))

    def take(self, portion: Portion) -> None:
        """Look at samples."""
        for value, numbers in zip(portion.values, portion.numbers, strict=True):
            limits = self._limits.get(value.path)
            if limits is not None:
                item, low, high = limits
                self._look(item, value, numbers, high, above=True)
                self._look(item, value, -numbers, -low, above=False)

    def _look(
        self, item: int, value: Any, numbers: NDArray[np.float64], limit: float, *, above: bool
    ) -> None:
        """Compare with a limit from above. For a lower limit, all signs are turned."""
        beyond = numbers > limit
        alarm = self._alarms.get((value.path, above))
        if not beyond.any():
            if alarm is not None and alarm.ended_s is None:
                self._end(alarm)
            return
        sign = 1.0 if above else -1.0
        worst = sign * float(np.nanmax(numbers))
        if alarm is None:
            alarm = Alarm(item, value.path, above, sign * limit, worst, time.time())
            self._alarms[value.path, above] = alarm
            self._tell(alarm, value)
        elif alarm.ended_s is not None:
            alarm.ended_s, alarm.seen_by, alarm.begun_s = None, "", time.time()
            alarm.count, alarm.worst = alarm.count + 1, worst
            self._tell(alarm, value)
        elif sign * worst > sign * alarm.worst:
            alarm.worst = worst
        if not beyond[-1]:
            self._end(alarm)

    def _tell(self, alarm: Alarm, value: Any) -> None:
        side, unit = "above" if alarm.above else "below", f" {value.unit}" if value.unit else ""
        self._note("alarm", f"{alarm.path} is {side} {alarm.limit:g}{unit}: {alarm.worst:g}{unit}")

    def _end(self, alarm: Alarm) -> None:
        alarm.ended_s = time.time()
        if alarm.seen_by:
            del self._alarms[alarm.path, alarm.above]

    def acknowledge(self, path: str, by: str) -> None:
        """Somebody has seen the alarms of an item. Raises UnknownName if it has none."""
        found = [alarm for alarm in self._alarms.values() if alarm.path == path]
        if not found:
            raise UnknownName(f"{shown(path)} has no alarm")
        for alarm in found:
            alarm.seen_by = alarm.seen_by or by
            if alarm.ended_s is not None:
                del self._alarms[alarm.path, alarm.above]
