# SPDX-License-Identifier: BSD-3-Clause
"""Take samples of one call, or of two sides in turns."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import median
from time import perf_counter_ns

Series = Callable[[int], Sequence[int]]  # takes a count; returns the times of so many calls in ns


@dataclass(frozen=True)
class Comparison:
    """Two sides that were measured in turns.

    The values are medians over the rounds: of each side's median in ns, and of their ratio.
    """

    ours_ns: float
    theirs_ns: float
    ratio: float  # median of ours / theirs within each round
    low: float  # the quartiles of that ratio, which show how much the rounds differ
    high: float

    def told_us(self, ours: str, theirs: str) -> dict[str, float]:
        """Return the details of a figure: the times of both sides in us, and the quartiles of the ratio.

        >>> Comparison(30_000, 20_000, 1.5, 1.4, 1.6).told_us("read", "bare")
        {'read us': 30.0, 'bare us': 20.0, 'quartile low': 1.4, 'high': 1.6}
        """
        return {
            f"{ours} us": self.ours_ns / 1e3,
            f"{theirs} us": self.theirs_ns / 1e3,
            "quartile low": self.low,
            "high": self.high,
        }


def times(call: Callable[[], object], count: int) -> list[int]:
    """Return the time of each of `count` calls in ns."""
    samples = [0] * count
    for index in range(count):
        start = perf_counter_ns()
        call()
        samples[index] = perf_counter_ns() - start
    return samples


def in_turns(ours: Series, theirs: Series, *, rounds: int, count: int) -> Comparison:
    """Measure both sides `rounds` times, with `count` calls each. Each round starts with the other side.

    The ratio is taken within each round, because a machine that slows down for a second slows down both
    sides.

    >>> in_turns(lambda n: [30] * n, lambda n: [20] * n, rounds=3, count=2)
    Comparison(ours_ns=30.0, theirs_ns=20.0, ratio=1.5, low=1.5, high=1.5)
    """
    pairs: list[tuple[float, float]] = []
    for index in range(rounds):
        if index % 2:
            b = median(theirs(count))
            a = median(ours(count))
        else:
            a = median(ours(count))
            b = median(theirs(count))
        pairs.append((float(a), float(b)))
    ratios = sorted(a / b for a, b in pairs)
    return Comparison(
        median(a for a, _ in pairs),
        median(b for _, b in pairs),
        median(ratios),
        ratios[rounds // 4],
        ratios[rounds - 1 - rounds // 4],
    )
