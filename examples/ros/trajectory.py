# SPDX-License-Identifier: BSD-3-Clause
"""A trajectory of joints: its points, and where the joints should be at a time between them."""

from __future__ import annotations

import math
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Point:
    """Where the joints are at a time after the start. Without velocities they pass it in any way."""

    time_s: float
    positions: tuple[float, ...]
    velocities: tuple[float, ...] = ()


class Trajectory:
    """Cubic between points with velocities, else straight.

    It begins at `start`, where the joints are. Raises ValueError for points that no robot can follow.
    """

    def __init__(self, start: Sequence[float], points: Sequence[Point]) -> None:
        if not points:
            raise ValueError("a trajectory without points")
        if not all(map(math.isfinite, start)):
            raise ValueError(f"a joint is at {list(start)}: it has no known position to start from")
        before = 0.0
        for number, point in enumerate(points):
            if point.time_s < before or (point.time_s == before and number > 0):
                raise ValueError(f"point {number} is not later than the one before it")
            before = point.time_s
            for numbers in (point.positions, point.velocities):
                if numbers and len(numbers) != len(start):
                    raise ValueError(f"point {number} has {len(numbers)} numbers for {len(start)} joints")
            if not point.positions or not all(map(math.isfinite, (*point.positions, *point.velocities))):
                raise ValueError(f"point {number} has a number that is missing or not finite")
        rest = tuple(0.0 for _ in start)
        begin = Point(0.0, tuple(start), rest)
        self._points = [begin, *points] if points[0].time_s > 0 else list(points)
        self._times = [point.time_s for point in self._points]

    @property
    def duration_s(self) -> float:
        return self._times[-1]

    @property
    def goal(self) -> tuple[float, ...]:
        return self._points[-1].positions

    def sample(self, time_s: float) -> tuple[float, ...]:
        """Return the positions at a time. Before the start and after the end the joints rest."""
        after = bisect_right(self._times, time_s)
        if after == len(self._times):
            return self.goal
        begin, end = self._points[max(0, after - 1)], self._points[after]
        span_s = end.time_s - begin.time_s
        done = min(1.0, max(0.0, (time_s - begin.time_s) / span_s)) if span_s > 0 else 1.0
        if not begin.velocities or not end.velocities:
            return tuple(a + done * (b - a) for a, b in zip(begin.positions, end.positions, strict=True))
        left = 1.0 - done
        ends = zip(begin.positions, begin.velocities, end.positions, end.velocities, strict=True)
        return tuple(  # a Hermite polynomial
            left * left * ((1 + 2 * done) * a + done * span_s * va)
            + done * done * ((3 - 2 * done) * b - left * span_s * vb)
            for a, va, b, vb in ends
        )
