# SPDX-License-Identifier: BSD-3-Clause
"""The live table of `watch`."""

from __future__ import annotations

import io

import pytest
from hypothesis import given
from hypothesis import strategies as st
from rich.console import Console

from unitylink.commands.live_table import Track, draw, trend
from unitylink.commands.names import Item
from unitylink.layer4_data import Publisher
from unitylink.layer4_data.publication import PublishReport


@given(st.lists(st.integers(-(2**31), 2**32), min_size=1, max_size=30))
def test_a_trend_keeps_the_order_of_values(values: list[int]) -> None:
    bars = trend(values)
    assert len(bars) == len(values)
    for (a, bar_a), (b, bar_b) in zip(
        zip(values, bars, strict=True), zip(values[1:], bars[1:], strict=True), strict=False
    ):
        assert (bar_a <= bar_b) if a <= b else (bar_a >= bar_b)
    if min(values) != max(values):
        assert bars[values.index(min(values))] == "▁" and bars[values.index(max(values))] == "█"


def test_a_track_knows_rate_and_extremes() -> None:
    track = Track()
    assert track.rate_hz == 0
    for index, number in enumerate([5, -3, 4]):
        track.take(index / 100, number)
    assert (track.minimum, track.maximum, track.values[-1]) == (-3, 5, 4)
    assert round(track.rate_hz) == 100


def test_the_table_shows_what_is_known() -> None:
    tracks = {"a": Track(), "b[1]": Track()}
    tracks["a"].take(0.0, -42)
    table = draw([Item("a", 1), Item("b[1]", 2)], tracks, Publisher(), "tcp://[::1]:5", "a read failed")
    out = io.StringIO()
    Console(file=out, width=120).print(table)
    shown = out.getvalue()
    assert "tcp://[::1]:5" in shown and "-42" in shown and "a read failed" in shown
    row = next(line for line in shown.splitlines() if "b[1]" in line)
    assert row.split() == ["b[1]", "-"]


@pytest.mark.parametrize("width", [30, 60, 80, 120])
def test_names_and_values_stay_whole_on_a_narrow_terminal(width: int) -> None:
    tracks = {"left.j1.cpos": Track()}
    tracks["left.j1.cpos"].take(0.0, -1234567)
    out = io.StringIO()
    table = draw([Item("left.j1.cpos", 1)], tracks, Publisher(), "sim:a.ul", "", width=width)
    Console(file=out, width=width).print(table)
    assert "left.j1.cpos" in out.getvalue() and " -1234567 " in out.getvalue()
    assert max(map(len, out.getvalue().splitlines())) <= width


class Reported(Publisher):
    """A publisher that reports the rates at which values should come."""

    def __init__(self, **rates_hz: float) -> None:
        super().__init__()
        self.rates_hz = rates_hz

    def reports(self) -> list[PublishReport]:
        return [
            PublishReport("sim:a.ul", True, rate_hz, (path,), 0, 0) for path, rate_hz in self.rates_hz.items()
        ]


@pytest.mark.parametrize(
    ("now_s", "old"), [(0.9, set()), (2.0, {"fast"}), (29.0, {"fast"}), (31.0, {"fast", "slow"})]
)
def test_an_overdue_value_is_grey_and_shows_its_age(now_s: float, old: set[str]) -> None:
    items = [Item("fast", 1), Item("slow", 2), Item("event", 3), Item("never", 4)]
    tracks = {item.name: Track() for item in items}
    for name in ("fast", "slow", "event"):
        tracks[name].take(0.0, 7)
    publisher = Reported(fast=100.0, slow=0.1, event=0.0, never=100.0)
    table = draw(items, tracks, publisher, "sim:a.ul", "", now_s=now_s)
    out = io.StringIO()
    Console(file=out, width=120, force_terminal=True, color_system="standard").print(table)
    rows = {name: next(r for r in out.getvalue().splitlines() if name in r) for name in tracks}
    for name, row in rows.items():
        assert (f"{now_s:.0f} s ago" in row) == (name in old), row
        assert ("\x1b[90m" in row or "\x1b[90;" in row) == (name in old), repr(row)
