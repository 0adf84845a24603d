# SPDX-License-Identifier: BSD-3-Clause
"""The binary messages to the page: rows of 64-bit floats, little-endian, so that a browser needs no parser.

A frame of values: [VALUES, now_s, n, n x (item, time_s, value), m, m x series].
A frame of a range: [RANGE, id, m, m x series].
A series: [item, step_s, k, k x (bucket, least, greatest)]; see `history.Buckets`.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from .feed import Feed, Track
from .history import Buckets, History

VALUES, RANGE = 1.0, 2.0


def floats(numbers: Iterable[float]) -> bytes:
    return np.array(list(numbers), "<f8").tobytes()


def latest(tracks: list[Track], since_round: int, sees: Sequence[bool] | None = None) -> bytes:
    """Return the newest value of each item that has come after a round, of those that a viewer sees."""
    rows: list[float] = []
    for number, track in enumerate(tracks):
        shown = track.round > since_round and (sees is None or sees[number])
        newest = track.history.newest() if shown else None
        if newest is not None:
            rows += [number, *newest]
    return floats([len(rows) // 3, *rows])


def series(item: int, step_s: float, buckets: Buckets) -> bytes:
    rows = np.stack((buckets.numbers.astype("<f8"), buckets.least, buckets.greatest), axis=1)
    return floats((item, step_s, len(rows))) + rows.astype("<f8").tobytes()


class Frames:
    """The frames of one round. Viewers who look at the same get the same bytes, made once.

    `refresh` begins a round.
    """

    def __init__(self, feed: Feed) -> None:
        self.feed = feed
        self._latest: dict[int, bytes] = {}
        self._series: dict[tuple[int, float, int], tuple[bytes, int]] = {}
        self.now_s = 0.0

    def refresh(self, now_s: float) -> None:
        self.feed.gather()
        self.now_s = now_s
        self._latest.clear()
        self._series.clear()

    def latest(self, since_round: int) -> bytes:
        """Return what `latest` returns."""
        if since_round not in self._latest:
            self._latest[since_round] = latest(self.feed.tracks, since_round)
        return self._latest[since_round]

    def series(self, item: int, step_s: float, first: int) -> tuple[bytes, int]:
        """Return a series from the bucket `first` on, and the number of its last bucket.

        The last bucket is not complete yet, so a viewer asks from it on the next time.
        """
        key = item, step_s, first
        if key not in self._series:
            begin_s, end_s = first * step_s, self.now_s + step_s
            found = self.feed.tracks[item].history.buckets(begin_s, end_s, step_s)
            last = int(found.numbers[-1]) if len(found.numbers) else first
            self._series[key] = series(item, step_s, found), max(first, last)
        return self._series[key]

    def range(
        self, item: int, step_s: float, begin_s: float, end_s: float, history: History | None = None
    ) -> bytes:
        """Return a series between two times, of what has come, or of another history."""
        history = history if history is not None else self.feed.tracks[item].history
        return series(item, step_s, history.buckets(begin_s, end_s, step_s))
