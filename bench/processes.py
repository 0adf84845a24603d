# SPDX-License-Identifier: BSD-3-Clause
"""Programs that run beside a bench, each a process of its own."""

from __future__ import annotations

import contextlib
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Sequence
from contextlib import ExitStack
from types import FrameType

END_S = 20.0  # how long a program has to end in order
_ROUTER = """
import sys, time
from unitylink.zenoh.session import Network
began_s = time.monotonic()
with Network(listen=sys.argv[1], connect=sys.argv[2]).opened():
    print(began_s, flush=True)
    sys.stdin.read()
"""


def router_program(locator: str, to: str = "") -> tuple[str, ...]:
    """Return the words of a router, which ends with this program. It is linked to the router at `to`.

    Its line is when it began to listen, by the monotonic clock.
    """
    return ("-c", _ROUTER, locator, to)


def end_on_signals() -> None:
    """Let SIGTERM and Ctrl-C end this program in order, once."""

    def end(number: int, frame: FrameType | None) -> None:
        for one in (signal.SIGTERM, signal.SIGINT):
            signal.signal(one, signal.SIG_IGN)
        raise SystemExit(128 + number)

    for one in (signal.SIGTERM, signal.SIGINT):
        signal.signal(one, end)


def free_port() -> int:
    """Return a port that nobody has."""
    with socket.create_server(("127.0.0.1", 0)) as one:
        return int(one.getsockname()[1])


class Processes:
    """Programs of Python beside this one, each of which says a line when it is ready. They end with it.

    `within` are words that come before the program, such as those of `ip netns exec`.
    """

    def __init__(self, stack: ExitStack) -> None:
        self._all: list[subprocess.Popen[str]] = []
        stack.callback(self._end)

    def begin(self, *words: str, within: Sequence[str] = (), quiet: bool = True) -> subprocess.Popen[str]:
        """Start one, and do not wait."""
        one = subprocess.Popen(
            [*within, sys.executable, *words],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL if quiet else None,
            text=True,
        )
        self._all.append(one)
        return one

    def start(
        self, *words: str, within: Sequence[str] = (), quiet: bool = True
    ) -> tuple[subprocess.Popen[str], str]:
        """Start one. Return it and its first line. What else it says is not kept."""
        one = self.begin(*words, within=within, quiet=quiet)
        line = first_line(one)
        threading.Thread(target=_read_all, args=(one,), daemon=True).start()
        return one, line

    def _end(self) -> None:
        for one in self._all:
            one.terminate()
        for one in self._all:
            with contextlib.suppress(subprocess.TimeoutExpired):
                one.wait(END_S)
            one.kill()
            one.wait()


def first_line(one: subprocess.Popen[str]) -> str:
    """Return the next line of a program."""
    assert one.stdout is not None
    line = one.stdout.readline()
    if not line:
        raise SystemExit(f"a program has ended: {one.args!r}")
    return line


def _read_all(one: subprocess.Popen[str]) -> None:
    """Let a program go on that says more than a pipe holds."""
    assert one.stdout is not None
    while one.stdout.read(4096):
        pass
