# SPDX-License-Identifier: BSD-3-Clause
"""A switch that something closes at a place: an end, or home."""

from __future__ import annotations

from unitylink.errors import ValueRangeError

from ..components import BoardComponent
from .checks import check_number

_BOUNCES = 3


class EndSwitch:
    """Drives an input of a component while a position is beyond a place.

        home = EndSwitch(registers.components["motor"], "home", below=0.002, hysteresis=0.0005)
        home.show(carriage_m)  # in each step

    It closes `below` a position or `above` one, and opens `hysteresis` further back. Position, place and
    hysteresis have one unit of your choice. `closed_level` is the level of a closed switch. When it closes it
    bounces for `bounce_ms`.
    """

    def __init__(
        self,
        component: BoardComponent,
        port: str,
        bit: int = 0,
        *,
        below: float | None = None,
        above: float | None = None,
        hysteresis: float = 0.0,
        closed_level: bool = True,
        bounce_ms: float = 0.0,
    ) -> None:
        where = f"switch at {component.configuration.path}.{port}"
        if (below is None) == (above is None):
            raise ValueRangeError(f"{where}: give either below or above, the position where it closes")
        self._sign, place = (-1.0, below) if below is not None else (1.0, above)
        assert place is not None
        name = "below" if self._sign < 0 else "above"
        self._place = self._sign * check_number(where, name, place)
        self._hysteresis = check_number(where, "hysteresis", hysteresis, least=0.0)
        self._bounce_s = check_number(where, "bounce_ms", bounce_ms, least=0.0) / 1000
        self._where, self._pins, self._port, self._bit = where, component, port, bit
        self._level = closed_level
        self.is_closed: bool | None = None  # None: not yet shown

    def show(self, position: float) -> None:
        """Tell where the thing is."""
        check_number(self._where, "position", position, remedy="look at what the plant computes")
        margin = self._hysteresis if self.is_closed else 0.0
        closed = self._sign * position > self._place - margin
        if closed is self.is_closed:
            return
        began = self.is_closed is None
        self.is_closed = closed
        level = self._level if closed else not self._level
        if began or not (closed and self._bounce_s):
            self._pins.drive(self._port, level, self._bit)
            return
        part_s = self._bounce_s / (2 * _BOUNCES)
        levels = [(number * part_s, level == (number % 2 == 0)) for number in range(2 * _BOUNCES + 1)]
        self._pins.play(self._port, levels, self._bit)
