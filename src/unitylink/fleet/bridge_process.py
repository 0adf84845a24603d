# SPDX-License-Identifier: BSD-3-Clause
"""One robot's bridge as a process of its own: started, watched, and started again after a pause."""

from __future__ import annotations

import math
import threading
from collections import deque
from collections.abc import Callable, Iterable
from typing import Protocol

from .turns import Turns

FIRST_PAUSE_S = 0.25  # after the first death; it doubles
PAUSE_MOST_S = 30.0
WELL_S = 30.0  # who has lived for so long begins with the first pause again
START_S = 60.0  # how long a bridge has to come to the network
SILENT_S = 5.0  # then a process that has left the network, and lives, is killed
STARVED_S = 0.001  # whose threads wait for so long for each of their turns is too late for the network
PATIENCE_S = 120.0  # how long such a process may be off the network
END_S = 5.0  # how long a process has to end in order
_LINES = 20
_LAST_LINES_S = 1.0  # how long the last lines of a process have to come


class Running(Protocol):
    """A process that has been started. `lines` is what it writes to stderr."""

    @property
    def lines(self) -> Iterable[str]: ...
    @property
    def pid(self) -> int: ...
    def poll(self) -> int | None:
        """Return the exit code, negative for a signal, or None while it runs."""
        ...

    def terminate(self) -> None: ...
    def kill(self) -> None: ...
    def wait(self, timeout_s: float | None = None) -> bool:
        """Wait until it has ended. Return whether it has."""
        ...

    def close(self) -> None: ...


class BridgeProcess:
    """Keeps what `start` starts running. Only the thread that calls `look` and `end` uses it.

    `restarts` counts how often it was started again, `trouble` is the last error that it printed.
    """

    def __init__(self, start: Callable[[], Running], said: Callable[[str], None]) -> None:
        self.restarts = 0
        self.trouble = ""
        self._launch, self._say = start, said
        self._process: Running | None = None
        self._lines: deque[str] = deque(maxlen=_LINES)
        self._reader: threading.Thread | None = None
        self._began_s = self._seen_s = self._due_s = 0.0
        self._pause_s = FIRST_PAUSE_S
        self._wait_until_s = 0.0  # how long a process may be off the network
        self._turns = Turns()  # those that it had when that began
        self.killed_s: float | None = None  # when it was killed for that; until it is on the network again

    @property
    def pid(self) -> int | None:
        """The number of the process, or None if it does not run."""
        return self._process.pid if self._process is not None else None

    def uptime_s(self, now_s: float) -> float:
        """How long the process has run."""
        return now_s - self._began_s if self._process is not None else 0.0

    def look(self, now_s: float, *, on_network: bool, may_kill: bool = True) -> None:
        """Start what should run and does not; kill what runs and is not on the network any more.

        One that waits for a processor is not killed before PATIENCE_S: its successor would wait even longer.
        """
        if self._process is None:
            if now_s >= self._due_s:
                self._start(now_s)
            return
        code = self._process.poll()
        if code is not None:
            self._ended(code, now_s)
        elif on_network:
            self._seen_s, self._wait_until_s, self.killed_s = now_s, 0.0, None
        elif not self._wait_until_s:  # it has just left
            self._wait(now_s + SILENT_S, Turns.of(self._process.pid))
        elif may_kill and now_s > self._wait_until_s:
            turns = Turns.of(self._process.pid)
            if now_s < self._seen_s + PATIENCE_S and turns.mean_wait_s(self._turns) > STARVED_S:
                self._wait(now_s + SILENT_S, turns)
                return
            self._say(f"process {self._process.pid} lives, and is not on the network: it is killed")
            self._process.kill()
            self.killed_s, self._wait_until_s = now_s, math.inf

    def _wait(self, until_s: float, turns: Turns) -> None:
        self._wait_until_s, self._turns = until_s, turns

    def ask_to_end(self) -> None:
        """Send SIGTERM."""
        if self._process is not None:
            self._process.terminate()

    def end(self) -> None:
        """End the process, in order if it can."""
        process, self._process = self._process, None
        if process is None:
            return
        process.terminate()
        if not process.wait(END_S):
            self._say(f"process {process.pid} does not end: it is killed")
            process.kill()
            process.wait()
        self._finish(process)

    def replace(self, start: Callable[[], Running]) -> None:
        """Run something else from now on. What ran is ended. This is no restart."""
        self.end()
        self._launch = start
        self._due_s, self._pause_s, self.trouble = 0.0, FIRST_PAUSE_S, ""

    def _start(self, now_s: float) -> None:
        self._began_s = self._seen_s = now_s
        self._wait(now_s + START_S, Turns())
        self._lines.clear()
        try:
            self._process = process = self._launch()
        except OSError as error:
            self._later(now_s, f"it cannot be started: {error.strerror or error}")
            return
        self._reader = threading.Thread(target=self._read, args=(process,), daemon=True)
        self._reader.start()

    def _read(self, process: Running) -> None:
        for line in process.lines:
            if not line.startswith("{"):  # a line of the audit, which has a file if it is wanted
                self._lines.append(line.rstrip())

    def _ended(self, code: int, now_s: float) -> None:
        process, self._process = self._process, None
        assert process is not None
        self._finish(process)
        said = " ".join(line for line in self._lines if line)[-300:]
        how = f"signal {-code}" if code < 0 else f"code {code}"
        if now_s - self._began_s >= WELL_S:
            self._pause_s = FIRST_PAUSE_S
        self._later(now_s, f"ended with {how}{': ' + said if said else ''}")

    def _later(self, now_s: float, why: str) -> None:
        self.trouble = why
        self.restarts += 1
        self._due_s = now_s + self._pause_s
        self._say(f"{why}; it is started again in {self._pause_s:g} s (restart {self.restarts})")
        self._pause_s = min(2 * self._pause_s, PAUSE_MOST_S)

    def _finish(self, process: Running) -> None:
        reader, self._reader = self._reader, None
        if reader is not None:
            reader.join(_LAST_LINES_S)
            if reader.is_alive():  # something that the process started still has its stderr
                threading.Thread(target=_close_after, args=(reader, process), daemon=True).start()
                return
        process.close()


def _close_after(reader: threading.Thread, process: Running) -> None:
    """Close what a thread reads from. Before its end, that would wait for it."""
    reader.join()
    process.close()
