# SPDX-License-Identifier: BSD-3-Clause
"""The screen: keys in, lines out. It never waits for the board."""

from __future__ import annotations

import asyncio
import os
import signal
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from typing import TYPE_CHECKING, Any, ClassVar

from textual.app import App
from textual.binding import Binding
from textual.widgets import Static

from unitylink.dashboard.description import describe
from unitylink.layer4_data import WriteValue

from .controls import Controls, part_of
from .dialogs import Question, TextBox, ValueBox
from .rows import ItemRow, Part, rows
from .screen_text import CHART_LINES, HELP, KEYS, Health, banner, charts_text, head
from .stop_key import with_stop_key
from .table import Table

if TYPE_CHECKING:
    from textual.app import ComposeResult
    from textual.driver import Driver

    from unitylink.dashboard.feed import Feed
    from unitylink.layer2_message import Link
    from unitylink.layer4_data import Node
    from unitylink.spec.model import Instance

REDRAW_S = 0.2
CHARTS_MOST = 4
WINDOWS_S = (5.0, 10.0, 20.0, 60.0, 300.0, 1800.0)
LOG_LINES = 3
GONE_S = 2.0  # for an end in order after the terminal was closed
HUNG_UP = 128 + signal.SIGHUP  # the exit code that shells give


class Screen(App[None]):
    """The dashboard of a robot in a terminal. `feed` brings values, and `controls` takes what is done.

    `in_order` tells at the end whether the person has quit. If not, nobody is there any more.
    """

    CSS = f"""
    * {{ background: ansi_default; color: ansi_default; }}
    ModalScreen {{ background: transparent; }}
    #box {{ border: ascii ansi_default; }}
    Static {{ height: 1; }}
    #table {{ height: 1fr; }}
    #charts {{ height: {CHART_LINES}; display: none; }}
    #log {{ height: {LOG_LINES}; }}
    #banner {{ display: none; text-style: bold reverse; }}
    #keys {{ text-style: reverse; }}
    """
    ENABLE_COMMAND_PALETTE = False
    BINDINGS: ClassVar[list[Any]] = [
        Binding("space", "stop", priority=True),  # before every box
        Binding("q,ctrl+c,ctrl+q", "leave"),
        Binding("up,k", "move(-1)"),
        Binding("down,j", "move(1)"),
        Binding("pageup", "move(-10)"),
        Binding("pagedown", "move(10)"),
        Binding("home", "move(-1000000)"),
        Binding("end", "move(1000000)"),
        Binding("enter", "act"),
        Binding("c", "chart"),
        Binding("plus,equals_sign", "window(1)"),
        Binding("minus", "window(-1)"),
        Binding("t", "take(False)"),
        Binding("T", "take(True)"),
        Binding("b", "give_back"),
        Binding("g", "go_on"),
        Binding("l", "messages"),
        Binding("question_mark", "help"),
    ]

    def __init__(self, link: Link, root: Instance, robot: Node, feed: Feed, controls: Controls) -> None:
        self._controls = controls  # before the driver is made, which may stop
        super().__init__(ansi_color=True)
        self.in_order = False
        self._link, self._root, self._feed = link, root, feed
        facts = {item["path"]: item for item in describe(root, robot)["items"]}
        self.table = Table(list(rows(root, facts)))
        self._tracks = {track.value.path: track for track in feed.tracks}
        self._charts: list[str] = []
        self._window = 2
        self.health = Health()
        self._asked_s = 0.0

    def get_driver_class(self) -> type[Driver]:
        """Return the driver of this terminal, which stops before anything else is done with the key."""
        return with_stop_key(super().get_driver_class(), self._controls.stop)

    def compose(self) -> ComposeResult:
        for name in ("head", "banner", "table", "charts", "log", "health", "keys"):
            yield Static(KEYS if name == "keys" else "", id=name, markup=False)

    def on_mount(self) -> None:
        if not self.is_headless:
            for number in (signal.SIGHUP, signal.SIGTERM):  # the terminal is closed
                asyncio.get_running_loop().add_signal_handler(number, self._gone)
        self.set_interval(REDRAW_S, self.redraw)
        self.redraw()

    def _gone(self) -> None:
        """Nobody is at the terminal any more. The outputs come first, because the screen may not end."""

        def leave() -> None:
            self._controls.lost()
            time.sleep(GONE_S)
            os._exit(HUNG_UP)  # textual may wait for a terminal that is closed

        threading.Thread(target=leave, name="unitylink-gone", daemon=True).start()
        self.exit()

    def on_resize(self) -> None:
        self.redraw()

    def redraw(self) -> None:
        """Show what is new."""
        self._controls.alive()
        if self._link.closed:
            self.exit()
            return
        self._feed.gather()
        if not self.screen_stack or not self.screen_stack[0].query("#keys"):
            return  # the screen is not there yet, or no more
        now_s = self._link.now_s()
        width = self.size.width
        if time.monotonic() - self._asked_s >= 1.0:
            self._asked_s = time.monotonic()
            self.run_worker(self._measure, thread=True, exclusive=True, exit_on_error=False)
        self._show("head", head(self._root.name, self._link, self._controls.control(), width))
        stopped = banner(self._link, self._controls.stopped_by, self._controls.stopping)
        self._show("banner", stopped)
        self._static("banner").display = bool(stopped)
        table = self._static("table")
        height = table.size.height or self.size.height - LOG_LINES - 3
        table.update(self.table.text(self._feed, self._charts, now_s, width, height))
        charts = self._static("charts")
        charts.display = bool(self._charts)
        if self._charts:
            window_s = WINDOWS_S[self._window]
            charts.update(charts_text(self._feed, self._charts, now_s, window_s, width))
        newest = list(self._controls.notes)[-LOG_LINES:]
        self._show("log", "\n".join(_note(*one)[:width] for one in newest))
        self._show("health", self.health.text(self._link, self._feed)[:width])

    def _measure(self) -> None:
        self.health.measure(self._feed, self._link.now_s())

    def _static(self, name: str) -> Static:
        return self.screen_stack[0].query_one(f"#{name}", Static)

    def _show(self, name: str, text: str) -> None:
        self._static(name).update(text)

    # -- keys

    def action_stop(self) -> None:
        self._controls.stop()
        self.redraw()

    def action_leave(self) -> None:
        self.in_order = True
        self.exit()

    def action_move(self, lines: int) -> None:
        self.table.move(lines)
        self.redraw()

    def action_window(self, longer: int) -> None:
        self._window = min(max(0, self._window + longer), len(WINDOWS_S) - 1)
        self.redraw()

    def action_chart(self) -> None:
        path = self.table.chosen.path
        if path in self._charts:
            self._charts.remove(path)
        elif isinstance(self.table.chosen, Part) or len(self._charts) == CHARTS_MOST:
            self._controls.note(f"a chart draws items, up to {CHARTS_MOST}; press c on one of them to end it")
        else:
            self._charts.append(path)
        self.redraw()

    def action_take(self, all_of_it: bool) -> None:
        self._controls.take("" if all_of_it else part_of(self.table.chosen.path))

    def action_give_back(self) -> None:
        self._controls.give_back()

    def action_go_on(self) -> None:
        self._controls.go_on()

    def action_messages(self) -> None:
        self.push_screen(TextBox("\n".join(_note(*one) for one in self._controls.notes) or "no messages"))

    def action_help(self) -> None:
        self.push_screen(TextBox(HELP))

    def action_act(self) -> None:
        """Do what Enter does to the chosen row."""
        row = self.table.chosen
        if isinstance(row, Part):
            self.table.fold(row)
            self.redraw()
            return
        if row.facts["verb"] is None:
            self._controls.note(f"{row.path} can only be read")
        elif not self._controls.has(row.path):
            self._controls.note(f"{row.path}: take control of {part_of(row.path)} first (key t)")
        else:
            self._ask(row)

    def _ask(self, row: ItemRow) -> None:
        path, confirm, track = row.path, row.facts["confirm"], self._tracks[row.path]
        if row.facts["verb"] == "pulse":
            self._confirmed(confirm or f"Send the pulse {path}?", lambda: self._controls.pulse(path))
        elif row.facts["verb"] == "clear":
            question, seen = confirm or f"Clear the flags of {path}?", self._feed.latest(path)
            self._confirmed(question, lambda: self._controls.clear(path, seen))
        elif isinstance(track.value, WriteValue):

            def given(answer: tuple[Any, str] | None) -> None:
                if answer is None:
                    return
                value, text = answer
                self._confirmed(confirm, lambda: self._controls.write(path, value, text))

            self.push_screen(ValueBox(row.element, track.value), given)

    def _confirmed(self, question: str | None, do: Callable[[], None]) -> None:
        if question is None:
            do()
        else:
            self.push_screen(Question(question), lambda yes: do() if yes else None)


def _note(time_s: float, text: str) -> str:
    return f"{time.strftime('%H:%M:%S', time.localtime(time_s))} {text}"


def run(screen: Screen, controls: Controls) -> None:
    """Show the screen until the person quits, or is gone. Then the parts under control are made safe."""
    try:
        screen.run()
    finally:
        if not screen.in_order:
            with suppress(KeyboardInterrupt):
                controls.lost()
