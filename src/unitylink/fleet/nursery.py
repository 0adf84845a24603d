# SPDX-License-Identifier: BSD-3-Clause
"""Where the processes of bridges come from: forks of one process that has imported all that a bridge needs.

Importing is most of what the start of a bridge costs. The process that is
forked has no threads and no sessions.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import signal
import sys
import threading
import time
from collections.abc import Callable, Sequence
from functools import partial
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TextIO

from .bridge_process import END_S

Main = Callable[[list[str]], int]


class Forked:
    """`main(arguments)` as a process in `folder`. `lines` is what it writes to stderr.

    It ends when the process that made it is gone, also if that was killed, and is ended if it does not within
    `end_s`. `imports` are the modules that are imported once for all.
    """

    def __init__(
        self,
        main: Main,
        arguments: Sequence[str],
        folder: Path,
        imports: Sequence[str],
        end_s: float = END_S,
    ) -> None:
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(list(imports))
        os.environ.setdefault(
            "OPENBLAS_NUM_THREADS", "1"
        )  # a fork has one thread, and a bridge needs no more
        listening, told = context.Pipe(duplex=False)
        ours, theirs = context.Pipe(duplex=False)
        watch = partial(_end_with, ours, end_s)
        self._process = context.Process(
            target=_run, args=(main, list(arguments), str(folder), told, watch), daemon=True
        )
        self._process.start()
        told.close()
        ours.close()
        self._alive = theirs
        self.lines: TextIO = os.fdopen(os.dup(listening.fileno()), encoding="utf-8", errors="replace")
        listening.close()

    @property
    def pid(self) -> int:
        """The number of the process."""
        assert self._process.pid is not None
        return self._process.pid

    def poll(self) -> int | None:
        """Return the exit code, negative for a signal, or None while it runs.

        If the process that was forked is killed, this is 255, though the fork lives. It is told to end then.
        """
        code = self._process.exitcode
        if code is not None:
            self._alive.close()
        return code

    def terminate(self) -> None:
        """Send SIGTERM."""
        with contextlib.suppress(ProcessLookupError):
            self._process.terminate()

    def kill(self) -> None:
        """Send SIGKILL."""
        with contextlib.suppress(ProcessLookupError):
            self._process.kill()

    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait until it has ended. Return whether it has."""
        self._process.join(timeout_s)
        return self._process.exitcode is not None

    def close(self) -> None:
        """Let go of a process that has ended."""
        self.lines.close()
        self._alive.close()
        self._process.close()


def _run(main: Main, arguments: list[str], folder: str, told: Connection, watch: Callable[[], None]) -> None:
    """The life of the child. `watch` ends it with its parent."""
    os.setsid()  # Ctrl-C is for the fleet, which ends its bridges itself
    os.chdir(folder)
    os.dup2(told.fileno(), 2)
    told.close()
    with open(os.devnull, "w", encoding="utf-8") as nothing:
        os.dup2(nothing.fileno(), 1)
    # New objects: those of the process that was forked may believe that they write to a file.
    sys.stdout = open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    sys.stderr = open(2, "w", encoding="utf-8", errors="backslashreplace", buffering=1, closefd=False)  # noqa: SIM115
    threading.Thread(target=watch, daemon=True).start()
    code = main(arguments)
    sys.stderr.flush()
    os._exit(code)


def _end_with(alive: Connection, end_s: float) -> None:
    """Nothing is ever sent: the other end is closed when its process is gone."""
    with contextlib.suppress(EOFError, OSError):
        alive.recv_bytes()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(end_s)
    os._exit(1)  # it hangs, and nobody is there to kill it
