# SPDX-License-Identifier: BSD-3-Clause
"""Where a robot with two driven wheels is, from how far they have turned.

>>> place = Odometry(radius_m=0.05, track_m=0.2)
>>> place.turned(0.0, 0.0, 0.0)
>>> place.turned(1.0, 2.0, 2.0)
>>> f"{place.x_m:.2f} m forward, {place.speed:.2f} m/s, {place.turn:.2f} rad/s"
'0.10 m forward, 0.10 m/s, 0.00 rad/s'
"""

from __future__ import annotations

import math

GAP_S = 1.0  # after a longer silence the wheels may have begun anew


class Odometry:
    """A place `x_m`, `y_m`, `heading` (rad), and the speeds `speed` (m/s) and `turn` (rad/s).

    It begins at the origin. x is forward, y is to the left, and a positive turn is to the left.
    """

    def __init__(self, radius_m: float, track_m: float) -> None:
        self._radius_m, self._track_m = radius_m, track_m
        self._before: tuple[float, float, float] | None = None
        self.x_m = self.y_m = self.heading = self.speed = self.turn = 0.0

    def turned(self, time_s: float, left: float, right: float) -> None:
        """Take the angles of both wheels, in rad, at a time. The way between two of them is an arc."""
        before, self._before = self._before, (time_s, left, right)
        if before is None or not 0 < time_s - before[0] <= GAP_S:
            self.speed = self.turn = 0.0
            return
        passed_s = time_s - before[0]
        left_m, right_m = self._radius_m * (left - before[1]), self._radius_m * (right - before[2])
        way_m, turned = (left_m + right_m) / 2, (right_m - left_m) / self._track_m
        chord_m = way_m * (math.sin(turned / 2) / (turned / 2) if turned else 1.0)
        self.x_m += chord_m * math.cos(self.heading + turned / 2)
        self.y_m += chord_m * math.sin(self.heading + turned / 2)
        self.heading = math.remainder(self.heading + turned, 2 * math.pi)
        self.speed, self.turn = way_m / passed_s, turned / passed_s
