# SPDX-License-Identifier: BSD-3-Clause
"""The table of `unitylink fleet`: drawn again on a terminal, and lines about changes anywhere else."""

from __future__ import annotations

import threading
import time
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from unitylink.fleet.report import HEADERS, RIGHT
from unitylink.line_writer import LineWriter

from .output import plain_table, terminal

if TYPE_CHECKING:
    from rich.table import Table

    from unitylink.fleet.report import RobotReport
    from unitylink.fleet.supervisor import Supervisor

_REDRAW_S = 0.5
_FIRST_S = 20.0  # how long the first table waits for robots
_NEWS = 6  # lines below the table
_WAITING_MOST = 1000  # lines that wait for a reader
_STATE_MOST = 60  # characters


class News:
    """What happened, with the time since the start. Printed soon, unless a table shows it.

    A `LineWriter` prints, so that a reader who does not read holds up nobody who looks after robots. Beyond
    _WAITING_MOST lines, the oldest that wait are left out, and a line says how many. `failed` is the error of
    the last line that could not be printed.
    """

    def __init__(self) -> None:
        self._began_s = time.monotonic()
        self._printer = LineWriter(self._print, most=_WAITING_MOST, tell_left_out=self._tell_left_out)
        self._lock = threading.Lock()  # guards `last`
        self.last: list[str] = []
        self.quiet = False
        self.failed: OSError | None = None

    def say(self, robot: str, text: str) -> None:
        """Take one. Any thread may call this. It goes on if nobody reads any more."""
        line = f"{time.monotonic() - self._began_s:6.1f} s  {robot}: {text}"
        with self._lock:
            self.last = [*self.last[-_NEWS + 1 :], line]
        if not self.quiet:
            self._printer.write(line)

    def finish(self, within_s: float) -> None:
        """Wait until all is printed, or the time is over. What comes later is not printed."""
        self._printer.close(within_s)

    def check(self) -> None:
        """Raise the OSError of a line that could not be printed. For the main thread."""
        if self.failed is not None:
            raise self.failed

    def _tell_left_out(self, count: int) -> None:
        self._print(f"{count} older lines are left out: nobody has read them in time")

    def _print(self, line: str) -> None:
        try:
            click.echo(line)
        except OSError as error:
            self.failed = error


def rows(reports: Sequence[RobotReport]) -> list[tuple[str, ...]]:
    """Return the rows of a table, with long states cut."""
    cut = [list(report.row()) for report in reports]
    for row in cut:
        if len(row[1]) > _STATE_MOST:
            row[1] = row[1][: _STATE_MOST - 1] + "…"
    return [tuple(row) for row in cut]


def show(fleet: Supervisor, news: News, stop: threading.Event) -> None:
    """Show the fleet until `stop`."""
    if not terminal():
        _show_lines(fleet, news, stop)
        return
    from rich.console import Group
    from rich.live import Live
    from rich.text import Text

    news.quiet = True
    with Live(auto_refresh=False) as live:

        def redraw() -> None:
            table = _drawn(fleet.reports(), fleet.fleet.name)
            live.update(Group(table, Text("\n".join(news.last))), refresh=True)

        while not stop.wait(_REDRAW_S):
            redraw()
        redraw()


def _show_lines(fleet: Supervisor, news: News, stop: threading.Event) -> None:
    """Print the table once all are up, or a while after the start; `News` prints what changes."""
    limit_s = time.monotonic() + _FIRST_S
    while not stop.is_set() and time.monotonic() < limit_s:
        if fleet.wait_up(_REDRAW_S):
            break
    if stop.is_set():
        return
    for line in plain_table(HEADERS, rows(fleet.reports()), right=RIGHT):
        click.echo(line)
    while not stop.wait(_REDRAW_S):  # with a timeout: a signal that comes to another thread wakes no wait
        news.check()


def _drawn(reports: Sequence[RobotReport], title: str) -> Table:
    from rich import box
    from rich.table import Table as New
    from rich.text import Text

    table = New(title=Text(title), box=box.SIMPLE_HEAD, title_justify="left", pad_edge=False)
    for index, header in enumerate(HEADERS):
        table.add_column(header, justify="right" if index in RIGHT else "left")
    for report, row in zip(reports, rows(reports), strict=True):
        style = "" if report.reachable else "bold red"
        table.add_row(*(Text(cell, style=style) for cell in row))
    return table
