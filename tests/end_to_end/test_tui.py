# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink tui` on a real terminal of 80 × 24, with the real command line."""

from __future__ import annotations

import fcntl
import json
import os
import pty
import select
import signal
import struct
import subprocess
import termios
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from unitylink import Link
from unitylink.errors import DeadManTripped, LeaseHeld

from .conftest import PATIENCE_S, UNITYLINK, Server

SPEC = """
public arm() {
   @position = 0x12: i32 READ(UNIT="mm", PUBLISH(100 Hz));
   @target = 0x1A: i32 WRITE(UNIT="mm", MIN=-100, MAX=100, SAFE=0);
   @power = 0x1B: u16 WRITE(SAFE=0);
}
"""
TARGET, POWER = 0x1A, 0x1B


class Terminal:
    """A terminal with a program in it."""

    def __init__(self, pid: int, descriptor: int) -> None:
        self.pid, self.descriptor, self.seen = pid, descriptor, ""

    def until(self, text: str) -> None:
        """Wait until the program shows `text`. What was before it is forgotten."""
        self.wait(lambda: text in self.seen)
        self.seen = self.seen.partition(text)[2]

    def wait(self, done: Callable[[], bool], reads: bool = True) -> None:
        """Wait until `done()`. Read what the program shows meanwhile, if the terminal `reads`."""
        end_s = time.monotonic() + PATIENCE_S
        while not done():
            assert time.monotonic() < end_s, self.seen
            if select.select([self.descriptor] if reads else [], [], [], 0.02)[0]:
                self.seen += os.read(self.descriptor, 65536).decode(errors="replace")

    def press(self, keys: str) -> None:
        os.write(self.descriptor, keys.encode())

    def set(self, value: str) -> None:
        """Type a value into the box of the target."""
        self.press("\r")
        self.until("-100 to 100 mm")
        self.press(f"{value}\r")

    def leave(self) -> int:
        """Leave a box and the program, and return the exit code.

        Escape is a key by itself only if no other follows at once, so a busy machine may need more of them.
        """
        end_s = time.monotonic() + PATIENCE_S
        while os.waitid(os.P_PID, self.pid, os.WEXITED | os.WNOHANG | os.WNOWAIT) is None:
            assert time.monotonic() < end_s, "it does not end"
            for key in ("\x1b", "q"):
                with suppress(OSError):  # it ends just now
                    self.press(key)
                    pause_s = time.monotonic() + 0.5
                    self.wait(lambda until_s=pause_s: time.monotonic() > until_s)
        return self.exit_code()

    def hang_up(self) -> None:
        """Close the terminal, as when ssh loses its connection."""
        os.close(self.descriptor)
        self.descriptor = -1

    def exit_code(self) -> int:
        """Wait for the end. What the program shows meanwhile is read, so that it can end."""
        end_s = time.monotonic() + PATIENCE_S
        while (ended := os.waitpid(self.pid, os.WNOHANG)) == (0, 0):
            assert time.monotonic() < end_s, f"it does not end: {self.seen!r}"
            if select.select([self.descriptor] if self.descriptor >= 0 else [], [], [], 0.02)[0]:
                with suppress(OSError):  # this is how Linux reports that the other side of a pty is closed
                    self.seen += os.read(self.descriptor, 65536).decode(errors="replace")
        self.pid = 0
        return os.waitstatus_to_exitcode(ended[1])


@contextmanager
def terminal(*arguments: object, columns: int = 80, **environment: str) -> Iterator[Terminal]:
    """Run `unitylink ARGUMENTS` in a terminal."""
    pid, descriptor = pty.fork()
    if pid == 0:
        os.environ.update(TERM="xterm-256color", **environment)
        os.execv(UNITYLINK, [str(UNITYLINK), *map(str, arguments)])
    fcntl.ioctl(descriptor, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
    one = Terminal(pid, descriptor)
    try:
        yield one
    finally:
        if one.pid:
            os.kill(one.pid, signal.SIGKILL)
            os.waitpid(one.pid, 0)
        if one.descriptor >= 0:
            os.close(one.descriptor)


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    path = tmp_path / "arm.ul"
    path.write_text(SPEC)
    return path


@pytest.fixture
def server(spec: Path) -> Iterator[str]:
    """The URL of a board that programs share. UNITYLINK_TOKEN is "together-0123456789"."""
    environment = {**os.environ, "UNITYLINK_TOKEN": "together-0123456789"}
    command = [UNITYLINK, "serve", f"sim:{spec}", spec, "--json", "--listen", "0"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, env=environment, text=True) as process:
        assert process.stdout is not None
        yield json.loads(process.stdout.readline())["urls"]["arm"]
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=PATIENCE_S)


def test_a_virtual_board_without_colours(spec: Path) -> None:
    with terminal("tui", f"sim:{spec}", NO_COLOR="1") as one:
        one.until("position")
        one.until("SPACE stop")
        one.press("q")
        assert one.exit_code() == 0


def test_a_board_at_a_server(server: str, spec: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("UNITYLINK_TOKEN", "together-0123456789")
    with Link(server) as other, terminal("tui", server, "--spec", spec) as one:
        one.until("SPACE stop")
        one.press("\x1b[Bt")
        one.until("you have control of target")
        one.set("3cm")
        one.wait(lambda: other.read(TARGET) == 30)
        one.press("\r")
        one.until("-100 to 100 mm")
        one.press("4 ")  # the space bar stops in a box, too
        one.wait(lambda: other.read(TARGET) == 0)
        with pytest.raises((DeadManTripped, LeaseHeld)):  # it is stopped, and for a moment being made safe
            other.write(TARGET, 5)
        one.until("STOPPED")
        assert one.leave() == 0


def test_a_terminal_that_is_closed_makes_its_parts_safe(
    server: str, spec: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("UNITYLINK_TOKEN", "together-0123456789")
    with Link(server) as other, terminal("tui", server, "--spec", spec) as one:
        one.until("SPACE stop")
        one.press("\x1b[Bt")
        one.until("you have control of target")
        one.set("30")
        one.wait(lambda: other.read(TARGET) == 30)
        one.hang_up()
        end_s = time.monotonic() + PATIENCE_S
        while other.read(TARGET) != 0:
            assert time.monotonic() < end_s
        one.exit_code()
        other.write(TARGET, 5)
        assert other.read(TARGET) == 5


def test_it_does_so_with_a_board_of_its_own(spec: Path, serve: Callable[..., Server]) -> None:
    port = spec.parent / "board.tty"
    serve(spec, "--pty", port)
    with terminal("tui", f"serial:{port}", "--spec", spec) as one:
        one.until("SPACE stop")
        one.press("\x1b[Bt")
        one.until("you have control of target")
        one.set("30")
        one.until("target = 30")
        one.hang_up()
        one.exit_code()
    with Link(f"serial:{port}?timeout=2") as link:
        assert link.read(TARGET) == 0


def test_the_space_bar_stops_while_the_screen_hangs(
    server: str, spec: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A terminal that takes nothing any more, as over a line that is stuck."""
    monkeypatch.setenv("UNITYLINK_TOKEN", "together-0123456789")
    with Link(server) as other, terminal("tui", server, "--spec", spec, columns=1000) as one:
        one.until("SPACE stop")
        one.press("\x1b[Bt")
        one.until("you have control of target")
        one.set("30")
        one.wait(lambda: other.read(TARGET) == 30)

        def draws_until_it_hangs() -> bool:
            one.press("jk")
            return other.read(TARGET) == 0  # because the screen gives no sign of life

        one.wait(draws_until_it_hangs, reads=False)
        other.write(POWER, 9)
        one.press(" ")
        one.wait(lambda: other.read(POWER) == 0, reads=False)
        with pytest.raises((DeadManTripped, LeaseHeld)):  # it is stopped, and for a moment being made safe
            other.write(POWER, 9)
