# SPDX-License-Identifier: BSD-3-Clause
"""A thermometer DS18B20 at the line of `one_wire`, as a plant uses it."""

from __future__ import annotations

from unitylink.errors import ValueRangeError

from .sensor import Sensor

_COLDEST, _HOTTEST = -55.0, 125.0
_TEMPERATURE, _CLOCKS, _RESTART = 16, 18, 22  # registers


class Thermometer(Sensor):
    """A DS18B20 with a supply of its own, or one that the line feeds.

        motor = board.components["motor"].thermometer()
        motor.warm(63.5)        # degC, of the next conversion
        motor.restart()         # its power was away for a moment: it says 85 degC until it has converted
        motor.plugged = False   # it neither hears nor answers

    A conversion takes `conversion_s`. Calls may come from any thread.
    """

    @property
    def conversion_s(self) -> float:
        """How long a conversion takes."""
        return self._clocks(_CLOCKS) / self._clock_hz

    @conversion_s.setter
    def conversion_s(self, seconds: float) -> None:
        if not 1e-3 <= seconds <= 10:
            raise ValueRangeError(f"a thermometer cannot convert in {seconds} s: give 0.001 to 10 s")
        clocks = round(self._clock_hz * seconds)
        self._put(_CLOCKS, clocks, 4)

    def warm(self, celsius: float) -> None:
        """Give it a temperature from -55 to 125 degC. Raises ValueRangeError for another one."""
        if not _COLDEST <= celsius <= _HOTTEST:
            raise ValueRangeError(f"a DS18B20 cannot have {celsius} degC: give -55 to 125 degC")
        self._put(_TEMPERATURE, round(16 * celsius) & 0xFFFF, 2)

    def restart(self) -> None:
        """Take its power away for a moment."""
        self._registers[_RESTART] = 1
