# SPDX-License-Identifier: BSD-3-Clause
"""A value over time, drawn with Braille characters. Each has 2 columns and 4 rows of dots."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from unitylink.dashboard.history import Buckets, History

_BLANK = 0x2800  # the Braille character without dots
_DOTS = ((0x01, 0x08), (0x02, 0x10), (0x04, 0x20), (0x40, 0x80))  # by row and column of a character


@dataclass(frozen=True)
class Picture:
    """Lines of text from top to bottom, and the values at their lower and upper edge."""

    lines: list[str]
    low: float
    high: float


def draw(history: History, end_s: float, window_s: float, width: int, height: int) -> Picture:
    """Draw the samples of the last `window_s` before `end_s`. `width` and `height` are in characters.

    Each column of dots goes from the least to the greatest sample of its time. So no peak is lost. Where no
    sample came the last value is held, up to the newest sample.
    """
    columns = 2 * width
    step_s = window_s / columns
    last = math.floor(end_s / step_s)
    first = last - columns + 1
    buckets = history.buckets(first * step_s, (last + 1) * step_s, step_s)
    spans = _spans(buckets, first, columns)
    finite = [edge for span in spans if span for edge in span]
    if not finite:
        return Picture([" " * width] * height, math.nan, math.nan)
    low, high = min(finite), max(finite)
    return Picture(_dots(spans, low, high, height), low, high)


def _spans(buckets: Buckets, first: int, columns: int) -> list[tuple[float, float] | None]:
    """Return the least and the greatest value of each column. They touch those of the column before."""
    spans: list[tuple[float, float] | None] = [None] * columns
    before: float | None = None
    drawn = 0
    for number, least, greatest in zip(
        buckets.numbers.tolist(), buckets.least.tolist(), buckets.greatest.tolist(), strict=True
    ):
        column = number - first
        if not 0 <= column < columns or not (math.isfinite(least) and math.isfinite(greatest)):
            continue
        if before is not None:
            for held in range(drawn, column):
                spans[held] = before, before
            spans[column] = min(least, before), max(greatest, before)
        else:
            spans[column] = least, greatest
        # the line goes on from that end of this column which is farther from where it began
        before = greatest if before is None or greatest - before >= before - least else least
        drawn = column + 1
    return spans


def _dots(spans: list[tuple[float, float] | None], low: float, high: float, height: int) -> list[str]:
    rows = 4 * height
    scale = (rows - 1) / (high - low) if high > low else 0.0
    cells = np.zeros((height, len(spans) // 2), np.int64)
    for column, span in enumerate(spans):
        if span is None:
            continue
        bottom, top = (round((edge - low) * scale) if scale else rows // 2 for edge in span)
        for level in range(bottom, top + 1):
            row = rows - 1 - level
            cells[row // 4, column // 2] |= _DOTS[row % 4][column % 2]
    return ["".join(chr(_BLANK + dots) if dots else " " for dots in line) for line in cells.tolist()]
