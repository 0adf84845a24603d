# SPDX-License-Identifier: BSD-3-Clause
"""The last samples of one item. Older ones are kept as the least and the greatest of 8, 64 and 512 samples.

So a chart of many minutes shows every peak, and the memory has a limit.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

CAPACITY = 1 << 14  # entries of each level
FACTOR = 8  # entries of a level that make one of the next
LEVELS = 4
FINE = 4  # a bucket has at least so many entries if there are coarser ones to choose


class Buckets(NamedTuple):
    """The least and the greatest value in each bucket of time that has samples. All have the shape (n,).

    Bucket b has the samples from b * step_s to (b + 1) * step_s.
    """

    numbers: NDArray[np.int64]
    least: Floats
    greatest: Floats


class _Level:
    """A ring of (time, least, greatest)."""

    def __init__(self) -> None:
        self.rows = np.empty((3, CAPACITY), np.float64)
        self.count = 0  # entries that there have ever been

    def add(self, rows: Floats) -> None:
        """Append entries, shape (3, n) with n up to CAPACITY."""
        start, n = self.count % CAPACITY, rows.shape[1]
        first = min(n, CAPACITY - start)
        self.rows[:, start : start + first] = rows[:, :first]
        self.rows[:, : n - first] = rows[:, first:]
        self.count += n

    def between(self, begin: int, end: int) -> Floats:
        """Return the entries begin to end, counted from the first one ever."""
        if end <= begin:
            return self.rows[:, :0]
        start = begin % CAPACITY
        if start + end - begin <= CAPACITY:
            return self.rows[:, start : start + end - begin]
        return np.concatenate((self.rows[:, start:], self.rows[:, : (end - 1) % CAPACITY + 1]), axis=1)

    @property
    def oldest(self) -> int:
        return max(0, self.count - CAPACITY)

    def first_at(self, time_s: float) -> int:
        """Return the number of the first entry that is not before `time_s`."""
        low, high = self.oldest, self.count
        while low < high:
            middle = (low + high) // 2
            if self.rows[0, middle % CAPACITY] < time_s:
                low = middle + 1
            else:
                high = middle
        return low


class History:
    """Samples of one item, the newest of them at the full rate.

    >>> history = History()
    >>> history.add(np.arange(10.0), np.array([0, 1, 2, 9, 4, 5, 6, 7, 8, 3.0]))
    >>> history.buckets(0.0, 10.0, step_s=5.0)
    Buckets(numbers=array([0, 1]), least=array([0., 3.]), greatest=array([9., 8.]))
    """

    def __init__(self) -> None:
        self._levels = [_Level() for _ in range(LEVELS)]

    @property
    def count(self) -> int:
        """How many samples there have been."""
        return self._levels[0].count

    def newest(self) -> tuple[float, float] | None:
        """Return (time in s, value) of the last sample, or None."""
        level = self._levels[0]
        if not level.count:
            return None
        time_s, value, _ = level.rows[:, (level.count - 1) % CAPACITY].tolist()
        return time_s, value

    def add(self, times_s: Floats, values: Floats) -> None:
        """Append samples, both of shape (n,). A time that goes back counts as the time before it."""
        for start in range(0, len(times_s), CAPACITY // 2):
            self._add(times_s[start : start + CAPACITY // 2], values[start : start + CAPACITY // 2])

    def _add(self, times_s: Floats, values: Floats) -> None:
        newest = self.newest()
        times_s = np.maximum.accumulate(times_s)
        if newest is not None:
            times_s = np.maximum(times_s, newest[0])
        rows = np.stack((times_s, values, values))
        for level, next_level in zip(self._levels, [*self._levels[1:], None], strict=True):
            whole = level.count // FACTOR
            level.add(rows)
            if next_level is None or level.count // FACTOR == whole:
                return
            parts = level.between(whole * FACTOR, level.count // FACTOR * FACTOR).reshape(3, -1, FACTOR)
            rows = np.stack(
                (parts[0, :, 0], np.fmin.reduce(parts[1], axis=1), np.fmax.reduce(parts[2], axis=1))
            )

    def buckets(self, begin_s: float, end_s: float, step_s: float) -> Buckets:
        """Return the buckets of [begin_s, end_s), from the coarsest level that is fine enough for the step.

        Where a finer one is needed and has been overwritten, the finest that is left is taken.
        """
        time_s, least, greatest = self._entries(begin_s, end_s, step_s)
        if not len(time_s):
            return Buckets(np.empty(0, np.int64), least, greatest)
        number = np.floor(time_s / step_s).astype(np.int64)
        starts = np.concatenate(([0], np.flatnonzero(np.diff(number)) + 1))
        return Buckets(number[starts], np.fmin.reduceat(least, starts), np.fmax.reduceat(greatest, starts))

    def samples(self, begin_s: float, end_s: float) -> Floats:
        """Return time, least and greatest, shape (3, n), of [begin_s, end_s) as finely as it is kept.

        For a sample of its own, the least value and the greatest are the same.
        """
        return self._entries(begin_s, end_s, 0.0)

    def _entries(self, begin_s: float, end_s: float, step_s: float) -> Floats:
        depth = self._depth(begin_s, end_s, step_s)
        parts = []
        done = None  # entries of this level that the coarser one has already
        for level in reversed(self._levels[: depth + 1]):
            begin, end = level.first_at(begin_s), level.first_at(end_s)
            parts.append(level.between(begin if done is None else max(begin, done), end))
            done = level.count * FACTOR
        return np.concatenate(parts, axis=1)

    def _depth(self, begin_s: float, end_s: float, step_s: float) -> int:
        for depth, level in enumerate(self._levels[:-1]):
            begin, end = level.first_at(begin_s), level.first_at(end_s)
            overwritten = level.oldest and begin == level.oldest
            too_fine = (end - begin) * step_s > FINE * FACTOR * max(end_s - begin_s, step_s)
            if not (overwritten or too_fine):
                return depth
        return LEVELS - 1
