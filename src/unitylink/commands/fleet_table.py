# SPDX-License-Identifier: BSD-3-Clause
"""The table of `unitylink fleet`: drawn again on a terminal, and lines about changes anywhere else."""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Sequence
from typing import TYPE_CHECKING

import click

from unitylink.fleet.report import HEADERS, RIGHT

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

    A thread of its own prints, so that a reader who does not read holds up nobody who looks after robots.
    Beyond _WAITING_MOST lines, the oldest that wait are left out, and counted. `failed` is the error of the
    last line that could not be printed.
    """

    def __init__(self) -> None:
        self._began_s = time.monotonic()
        self._changed = threading.Condition()  # guards what follows
        self._waiting: deque[str] = deque()
        self._left_out = 0
        self._printing = False
        self._printer: threading.Thread | None = None
        self.last: list[str] = []
        self.quiet = False
        self.failed: OSError | None = None

    def say(self, robot: str, text: str) -> None:
        """Take one. Any thread may call this. It goes on if nobody reads any more."""
        line = f"{time.monotonic() - self._began_s:6.1f} s  {robot}: {text}"
        with self._changed:
            self.last = [*self.last[-_NEWS + 1 :], line]
            if self.quiet:
                return
            if len(self._waiting) == _WAITING_MOST:
                self._waiting.popleft()
                self._left_out += 1
            self._waiting.append(line)
            if self._printer is None:
                self._printer = threading.Thread(target=self._print, name="fleet news", daemon=True)
                self._printer.start()
            self._changed.notify_all()

    def finish(self, within_s: float) -> None:
        """Wait until all is printed, or the time is over."""
        with self._changed:
            self._changed.wait_for(lambda: not (self._waiting or self._printing), within_s)

    def check(self) -> None:
        """Raise the OSError of a line that could not be printed. For the main thread."""
        if self.failed is not None:
            raise self.failed

    def _print(self) -> None:
        while True:
            with self._changed:
                self._printing = False
                self._changed.notify_all()
                self._changed.wait_for(lambda: self._waiting)
                line, self._printing = self._waiting.popleft(), True
                if self._left_out:
                    line = f"{self._left_out} older lines are left out: nobody has read them in time\n{line}"
                    self._left_out = 0
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
