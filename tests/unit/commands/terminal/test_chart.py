# SPDX-License-Identifier: BSD-3-Clause
"""Charts of Braille dots, compared with a second way to find each dot."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest

from unitylink.commands.terminal.chart import draw
from unitylink.dashboard.history import History


def dots(lines: list[str]) -> set[tuple[int, int]]:
    """Return (column, row from below) of each dot. In Unicode, dots 1 to 8 are the bits of the character."""
    places = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3)]
    return {
        (2 * x + places[bit][0], 4 * len(lines) - 1 - (4 * y + places[bit][1]))
        for y, line in enumerate(lines)
        for x, sign in enumerate(line)
        if sign != " "
        for bit in range(8)
        if ord(sign) - 0x2800 >> bit & 1
    }


@pytest.mark.parametrize("seed", range(5))
def test_every_sample_has_its_dot(seed: int) -> None:
    random = np.random.default_rng(seed)
    times_s = np.sort(random.uniform(0, 10, 400))
    values = np.cumsum(random.normal(size=400))
    history = History()
    history.add(times_s, values)
    end_s, window_s, width, height = 9.999, 8.0, 20, 3
    picture = draw(history, end_s, window_s, width, height)
    step_s = window_s / (2 * width)
    first = math.floor(end_s / step_s) - 2 * width + 1
    seen = times_s >= first * step_s
    assert (picture.low, picture.high) == (values[seen].min(), values[seen].max())
    drawn = dots(picture.lines)
    for time_s, value in zip(times_s[seen], values[seen], strict=True):
        row = round((value - picture.low) / (picture.high - picture.low) * (4 * height - 1))
        assert (math.floor(time_s / step_s) - first, row) in drawn
    assert all(len(line) == width for line in picture.lines)
    rows = [[row for at, row in drawn if at == column] for column in range(2 * width)]
    for left, right in pairwise(rows):
        if left and right:
            assert min(right) <= max(left) and max(right) >= min(left), "the line has a gap"


def test_a_peak_of_one_sample_among_many_is_seen() -> None:
    history = History()
    values = np.zeros(100_000)
    values[61_234] = 5.0
    history.add(np.arange(100_000) / 1000, values)
    picture = draw(history, 99.999, 100.0, 30, 2)
    assert picture.high == 5.0 and max(row for _, row in dots(picture.lines)) == 7


def test_a_value_is_held_until_its_newest_sample_and_no_longer() -> None:
    history = History()
    history.add(np.array([0.05, 5.05]), np.array([1.0, 2.0]))
    columns = {column for column, _ in dots(draw(history, 9.95, 10.0, 50, 1).lines)}
    assert columns == set(range(51))


def test_nothing_to_draw() -> None:
    history = History()
    assert draw(history, 1.0, 1.0, 4, 2).lines == ["    ", "    "]
    history.add(np.array([0.5]), np.array([math.nan]))
    assert math.isnan(draw(history, 1.0, 1.0, 4, 2).low)
    history.add(np.array([0.6]), np.array([3.0]))
    assert len(dots(draw(history, 1.0, 1.0, 4, 2).lines)) == 1
