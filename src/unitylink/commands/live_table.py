# SPDX-License-Identifier: BSD-3-Clause
"""The live table of `unitylink watch`."""

from __future__ import annotations

import logging
import math
import time
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any

from rich import box
from rich.console import Console
from rich.live import Live
from rich.table import Table
from rich.text import Text

from .names import Item
from .value_text import shown

if TYPE_CHECKING:
    from unitylink.layer4_data import Publisher

    from .sampler import Sample

_REDRAW_S = 0.1
_STALE_S = 1.0  # no value is stale before this age, however high its rate is
_STALE_PERIODS = 3  # nor before so many of its samples are overdue
_TREND = 24  # values in the trend column
_BARS = "▁▂▃▄▅▆▇█"


class Track:
    """The row of one item in the table: its last value and numbers, extremes, and rate.

    For a packed value, or one that is not a finite number, only the last value is kept.
    """

    def __init__(self) -> None:
        self.latest: Any = None
        self.values: deque[float] = deque(maxlen=_TREND)
        self.times_s: deque[float] = deque(maxlen=200)
        self.minimum = self.maximum = 0.0

    def take(self, time_s: float, value: Any) -> None:
        self.latest = value
        self.times_s.append(time_s)
        if not isinstance(value, (int, float)) or not math.isfinite(value):
            return
        if not self.values:
            self.minimum = self.maximum = value
        self.minimum, self.maximum = min(self.minimum, value), max(self.maximum, value)
        self.values.append(value)

    def stale_s(self, now_s: float, expected_hz: float) -> float | None:
        """Return the age of the last sample in s if the samples are overdue.

        `expected_hz` is their rate, 0 for no rate.
        """
        if not self.times_s or expected_hz <= 0:
            return None
        age_s = now_s - self.times_s[-1]
        return age_s if overdue(age_s, expected_hz) else None

    @property
    def rate_hz(self) -> float:
        """The measured rate of the last samples, or 0 if there are fewer than two."""
        span_s = self.times_s[-1] - self.times_s[0] if self.times_s else 0.0
        return (len(self.times_s) - 1) / span_s if span_s > 0 else 0.0


def overdue(age_s: float, expected_hz: float) -> bool:
    """Tell whether a value of this age should have come again. With a rate of 0 it never should."""
    return expected_hz > 0 and age_s > max(_STALE_S, _STALE_PERIODS / expected_hz)


def trend(values: Sequence[float]) -> str:
    """Draw values as bars between the smallest and the largest one.

    >>> trend([0, 5, 10])
    '▁▄█'
    """
    if not values:
        return ""
    low, span = min(values), max(values) - min(values) or 1
    return "".join(_BARS[int((value - low) * (len(_BARS) - 1) / span)] for value in values)


class _LastMessage(logging.Handler):
    """Keeps the last logged message (a failed read) for the line below the table."""

    text = ""

    def emit(self, record: logging.LogRecord) -> None:
        self.text = record.getMessage()


def show(
    samples: Iterable[Sample | None],
    items: Sequence[Item],
    publisher: Publisher,
    link: str,
    now_s: Callable[[], float] = time.monotonic,
) -> None:
    """Draw the samples until they end. The last table stays on the terminal. `now_s` is their clock."""
    tracks = {item.name: Track() for item in items}
    messages = _LastMessage()
    logger = logging.getLogger("unitylink")
    logger.addHandler(messages)
    drawn = 0.0
    try:
        console = Console()
        with Live(console=console, auto_refresh=False) as live:

            def redraw() -> None:
                table = draw(
                    items, tracks, publisher, link, messages.text, width=console.width, now_s=now_s()
                )
                live.update(table, refresh=True)

            for sample in samples:
                if sample is not None:
                    time_s, values, numbers = sample
                    for value, number in zip(values, numbers, strict=True):
                        tracks[value.path].take(time_s, number)
                if time.monotonic() - drawn >= _REDRAW_S:
                    redraw()
                    drawn = time.monotonic()
            redraw()
    finally:
        logger.removeHandler(messages)


def draw(
    items: Sequence[Item],
    tracks: dict[str, Track],
    publisher: Publisher,
    link: str,
    message: str,
    *,
    width: int = 120,
    now_s: float | None = None,
) -> Table:
    """Return the current table. On a narrow terminal it has only names and values.

    An item that is overdue at `now_s` is grey, with its age in place of its rate. `now_s` is by the clock of
    the samples, by default now.
    """
    now_s = time.monotonic() if now_s is None else now_s
    table = Table(
        title=Text(link),
        box=box.SIMPLE_HEAD,
        title_justify="left",
        caption_justify="left",
        caption=Text(message) if message else None,
    )
    names = max((len(item.name) for item in items), default=0)
    units = any(item.unit for item in items)
    bars, extremes = width >= names + 55, width >= names + 90  # the widths that these columns need
    table.add_column("name", style="bold", no_wrap=True)
    table.add_column("value", justify="right", style="cyan", min_width=11, no_wrap=True)
    if units:
        table.add_column("unit")
    if extremes:
        table.add_column("min", justify="right", style="dim")
        table.add_column("max", justify="right", style="dim")
    table.add_column("rate", justify="right")
    if extremes:
        table.add_column("from", style="dim")
    if bars:
        table.add_column("trend", min_width=_TREND, no_wrap=True, style="green")
    reports = {path: report for report in publisher.reports() for path in report.paths}
    for item in items:
        track = tracks[item.name]
        known = bool(track.times_s)
        report = reports.get(item.name)
        age_s = track.stale_s(now_s, report.rate_hz if report else 0.0)
        grey = "" if age_s is None else "bright_black"
        rate = f"{track.rate_hz:.0f} Hz" if track.rate_hz else ""
        ends = [shown(end, item.quantity) if track.values else "" for end in (track.minimum, track.maximum)]
        table.add_row(
            Text(item.name),
            Text(shown(track.latest, item.quantity), style=grey) if known else "-",
            *([Text(item.unit)] if units else []),
            *ends[: 2 * extremes],
            rate if age_s is None else Text(f"{age_s:.0f} s ago", style=grey),
            *([("gateware" if report.hardware else "polled") if report else ""] if extremes else []),
            *([Text(trend(track.values), style=grey)] if bars else []),
        )
    return table
