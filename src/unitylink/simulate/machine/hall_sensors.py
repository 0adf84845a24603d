# SPDX-License-Identifier: BSD-3-Clause
"""The three Hall sensors of a brushless motor."""

from __future__ import annotations

import math

from ..components import BoardComponent
from .checks import check_number, check_whole

_CODES = (0b101, 0b001, 0b011, 0b010, 0b110, 0b100)  # of the sectors, with the line 0 as bit 0


class HallSensors:
    """Shows the angle of a rotor to a `hall`, with six sectors in each electrical turn.

        sensors = HallSensors(registers.components["rotor"], pole_pairs=7)
        sensors.show(angle_rad, self.period_s)  # in each step

    `offset_deg` is how far the sensors are turned, in electrical degrees. All sectors on the way are passed,
    evenly within a step.
    """

    def __init__(self, component: BoardComponent, pole_pairs: int, *, offset_deg: float = 0.0) -> None:
        self._where = f"Hall sensors at {component.configuration.path}"
        self._pins = component
        self._pole_pairs = check_whole(self._where, "pole_pairs", pole_pairs)
        self._offset = math.radians(check_number(self._where, "offset_deg", offset_deg))
        self._sector: int | None = None

    def show(self, angle_rad: float, seconds: float) -> int:
        """Turn the rotor to an angle within a step of the plant. Return its sector, counted on."""
        check_number(self._where, "angle_rad", angle_rad, remedy="look at what the plant computes")
        sector = math.floor((self._pole_pairs * angle_rad - self._offset) * 3 / math.pi)
        before = sector - 1 if self._sector is None else self._sector
        if sector == before:
            return sector
        way = 1 if sector > before else -1
        passed = range(before + way, sector + way, way)
        part_s = 0.0 if self._sector is None else seconds / len(passed)
        self._sector = sector
        code = _CODES[before % 6] if part_s else ~_CODES[sector % 6]
        for number, one in enumerate(passed):
            changed, code = code ^ _CODES[one % 6], _CODES[one % 6]
            for line in range(3):
                if changed >> line & 1:
                    level = bool(code >> line & 1)
                    if part_s:
                        self._pins.play("lines", [(number * part_s, level)], line)
                    else:
                        self._pins.drive("lines", level, line)
        return sector
