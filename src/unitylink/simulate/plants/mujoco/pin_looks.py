# SPDX-License-Identifier: BSD-3-Clause
"""Looks at the pins between two steps of a model, for loops in the gateware that are quicker than these."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from unitylink.interface.components import placed_components
from unitylink.spec.model import Spec

from .drives import Drive, WindingsDrive
from .shown import Shown, ShownAbsolute, ShownCurrents

_QUICK_LOOPS = ("foc",)


def looks_of(spec: Spec | None, period_s: float) -> int:
    """Return how often to look in a period of the model: as often as a loop of currents runs in it."""
    loops = [one for one in placed_components(spec) if one.entity in _QUICK_LOOPS] if spec else []
    facts: list[dict[str, Any]] = [dict(one.generics) for one in loops]
    return max((round(int(one["loop_hz"]) * period_s) for one in facts), default=1) or 1


class PinLooks:
    """What happens between two steps of a model: motors run on at their speed, and sensors tell."""

    def __init__(self, count: int, seconds: float, drives: Sequence[Drive], shown: Sequence[Shown]) -> None:
        self._count, self._seconds = count, seconds
        self._drives = [one for one in drives if isinstance(one, WindingsDrive)]
        self.shown = [one for one in shown if isinstance(one, (ShownCurrents, ShownAbsolute))]
        self._number = 0

    def due(self) -> bool:
        """Look once. Return whether the model steps now, and let the sensors tell if it does not."""
        for drive in self._drives:
            drive.look(self._seconds)
        self._number = (self._number + 1) % self._count
        if self._number:
            self.show()
        return self._number == 0

    def show(self) -> None:
        """Let the sensors tell how it is now."""
        for shown in self.shown:
            shown.show(self._seconds)
