# SPDX-License-Identifier: BSD-3-Clause
"""A screen of `unitylink tui` with a virtual board behind it, and a person who presses keys."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable
from typing import Any

from textual.events import Key
from textual.keys import _character_to_key
from textual.pilot import Pilot
from textual.widgets import Static
from unit.dashboard.robot import Still, compiled

from unitylink import Link, connect
from unitylink.commands.terminal.app import Screen
from unitylink.commands.terminal.controls import Controls
from unitylink.commands.terminal.opening import open_screen
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec.model import Spec

TARGET, GRIP, RESET, FAULTS = 0x12, 0x30, 0x34, 0x35
LIMIT_S = 10.0
PARTS = ("head", "banner", "table", "charts", "log", "health", "keys")


class Shown:
    """A screen, by default of 80 × 24 characters."""

    def __init__(self, screen: Screen, controls: Controls, pilot: Pilot[None], registers: Any = None) -> None:
        self.screen, self.controls, self.pilot, self.registers = screen, controls, pilot, registers

    def text(self, name: str = "") -> str:
        """Return what a person sees of one part of the screen, or of all parts."""
        if name:
            return str(self.screen.screen_stack[0].query_one(f"#{name}", Static).content)
        return "\n".join(map(self.text, PARTS))

    def line(self, name: str) -> str:
        """Return the first line of the table that has this name."""
        return next(line for line in self.text("table").splitlines() if f" {name} " in line)

    @property
    def box(self) -> str:
        """The text of the box that is open, or ""."""
        if len(self.screen.screen_stack) == 1:
            return ""
        return "\n".join(str(one.content) for one in self.screen.screen.query(Static))

    @property
    def notes(self) -> str:
        return "\n".join(text for _, text in self.controls.notes)

    async def press(self, *keys: str) -> None:
        """Press keys, each when the one before is done. Pilot.press() waits for an idle processor instead."""
        for key in keys:
            typed = len(key) == 1
            self.screen.post_message(Key(_character_to_key(key) if typed else key, key if typed else None))
            await self.pilot._wait_for_screen()
            await self.pilot._wait_for_screen()

    async def until(self, done: Callable[[], Any]) -> None:
        end_s = time.monotonic() + LIMIT_S
        while not done():
            assert time.monotonic() < end_s, f"{self.text()}\n{self.notes}\n{self.box}"
            await asyncio.sleep(0.02)

    async def go_to(self, path: str) -> None:
        """Move the cursor to a row."""
        await self.press("home")
        for _ in self.screen.table.rows:
            if self.screen.table.chosen.path == path:
                return
            await self.press("down")
        raise AssertionError(self.text("table"))

    async def take(self, path: str) -> None:
        """Move the cursor to a row, and take control of its part."""
        await self.go_to(path)
        await self.press("t")
        await self.until(lambda: self.controls.has(path))


Body = Callable[[Shown], Awaitable[None]]


def show(link: Link, spec: Spec, body: Body, registers: Any = None, size: tuple[int, int] = (80, 24)) -> None:
    """Run `body` at the screen of a link."""

    async def run() -> None:
        async with screen.run_test(size=size) as pilot:
            await body(Shown(screen, controls, pilot, registers))

    with open_screen(link, spec, read_hz=20.0) as (screen, controls):
        asyncio.run(run())


def at_screen(body: Body, size: tuple[int, int] = (80, 24)) -> None:
    """Run `body` at the screen of a virtual board on which nothing moves."""
    spec = compiled()
    configuration = BoardConfiguration.for_spec(spec)
    with (
        Board(spec, configuration=configuration, plant=Still()) as board,
        connect(f"{board.url}?timeout=2") as link,
    ):
        show(link, spec, body, board.registers, size)
