# SPDX-License-Identifier: BSD-3-Clause
"""What the screen says around the table: head, charts, the health of the link. No colour is needed."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rich.text import Text

from unitylink.values import format_value

from .chart import draw

if TYPE_CHECKING:
    from unitylink.dashboard.feed import Feed
    from unitylink.layer2_message import Link

KEYS = "SPACE stop  Enter set  c chart  t/T take  b give back  g go on  ? help  q quit"
HELP = """SPACE     stop: write all SAFE values, and end all writes. It works in every box.
g         go on after a stop
up, down  choose a row
Enter     set a value, send a pulse, clear flags, or fold a part
t, T      take control of the part of this row, or of the whole robot
b         give control back; the outputs keep their values
c         draw the value of this row, or end that (up to 4)
+, -      draw a longer or a shorter time
l         all messages
q         quit; the outputs keep their values

A value that is overdue is marked `late`. BELOW and ABOVE show the limit that a value is beyond.
If the screen hangs or the terminal is closed, control ends and the outputs get their SAFE values.
This stop is no emergency stop: it needs this program, the link and the gateware."""
CHART_LINES = 6
LABEL = 25  # columns beside a chart


def charts_text(feed: Feed, charts: Sequence[str], now_s: float, window_s: float, width: int) -> Text:
    """Return the charts below each other, each with its own scale. Together they have CHART_LINES lines."""
    tracks = {track.value.path: track for track in feed.tracks}
    height = CHART_LINES // len(charts)
    lines = []
    for number, path in enumerate(charts, 1):
        track = tracks[path]
        picture = draw(track.history, now_s, window_s, max(4, width - LABEL), height)
        unit = f" {track.value.unit}" if track.value.unit else ""
        labels = [f"{number} {path}"] * (height == 1) or [f"{number} {path}", *[""] * (height - 1)]
        if not math.isnan(picture.low):
            edges = f"  {_short(picture.low)} to {_short(picture.high)}{unit}"
            labels[-1] = edges if height > 1 else f"{labels[0]}{edges}"
        if height > 2:
            labels[1] = f"  last {window_s:g} s"
        lines += [
            f"{label[: LABEL - 1]:<{LABEL}}{line}" for label, line in zip(labels, picture.lines, strict=True)
        ]
    return Text("\n".join(lines))


def _short(number: float) -> str:
    return format_value(float(f"{number:.4g}"))


def head(robot: str, link: Link, control: Mapping[str, str], width: int) -> str:
    """Return the first line: which robot, by which link, and who has control."""
    held = ", ".join(f"{part}: {who}" for part, who in control.items()) or "nobody"
    return f"{robot}  {link.url.partition('?')[0]}  control: {held}"[:width]


def banner(link: Link, stopped_by: str, stopping: bool) -> str:
    """Return what has to be seen at once, or an empty text."""
    if stopping:
        return "STOP: the board has not answered yet. It is tried again and again."
    if stopped_by:
        return f"STOPPED by {stopped_by}. Nothing is written before you press g (go on)."
    if not link.up:
        return f"THE LINK IS DOWN: {link.trouble or 'no answer'}. Values are old."
    return ""


@dataclass
class Health:
    """The line about the link: round trip, how many publishes come and were asked for, what was lost."""

    round_trip_s: float | None = None
    came_hz: float = 0.0
    _received: int = 0
    _at_s: float = 0.0

    def measure(self, feed: Feed, now_s: float) -> None:
        """Count the publishes since the last call, and measure a round trip. It waits for the board."""
        received = sum(report["received"] for report in feed.reports())
        if now_s > self._at_s > 0:
            self.came_hz = (received - self._received) / (now_s - self._at_s)
        self._received, self._at_s = received, now_s
        self.round_trip_s = feed.round_trip_s()

    def text(self, link: Link, feed: Feed) -> str:
        counted = link.statistics()
        reports = feed.reports()
        trip = "-" if self.round_trip_s is None else f"{1e3 * self.round_trip_s:.2f}"
        asked_hz = sum(report["rate_hz"] for report in reports)
        lost = sum(report["lost"] for report in reports)
        return (
            f"{'' if link.up else 'link DOWN, '}round trip {trip} ms, {self.came_hz:.0f} of {asked_hz:.0f} "
            f"publishes/s, lost {lost}, retries {counted.retries}, timeouts {counted.timeouts}"
        )
