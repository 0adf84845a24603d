# SPDX-License-Identifier: BSD-3-Clause
"""An ultrasonic distance sensor at the lines of `sonar`, as a plant uses it."""

from __future__ import annotations

from unitylink.errors import ValueRangeError

from .sensor import Sensor

_SOUND_M_PER_S = 343.0  # at 20 degC
_METRES_MOST = 30.0


class DistanceSensor(Sensor):
    """A sensor such as the HC-SR04. It answers each trigger with an echo.

        sensor = board.components["front"].distance_sensor()
        sensor.see(0.75)        # m
        sensor.see(None)        # nothing reflects
        sensor.plugged = False  # it does not answer

    It begins with nothing that reflects. Calls may come from any thread.
    """

    @property
    def shortest_s(self) -> dict[str, float]:
        """The shortest times that it has seen: `trigger`, and `cycle` from trigger to trigger."""
        return self._registers.shortest_s

    def see(self, distance_m: float | None) -> None:
        """Put something at a distance of up to 30 m, or nothing. Raises ValueRangeError for another distance.

        The next trigger sees it.
        """
        if distance_m is not None and not 0 < distance_m <= _METRES_MOST:
            raise ValueRangeError(f"a sonar cannot see {distance_m} m: give more than 0 and at most 30 m")
        echo_us = 0 if distance_m is None else max(1, round(2e6 * distance_m / _SOUND_M_PER_S))
        self._put(0, echo_us, 4)
