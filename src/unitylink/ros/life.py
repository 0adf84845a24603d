# SPDX-License-Identifier: BSD-3-Clause
"""Whether a node's threads work. The link learns this, and through it the gateware's dead-man."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable

LOOK_S = 0.05
PATIENCE_S = 1.0  # for a thread that gives no sign
DEVICE_S = 10.0  # for one that waits for an answer of the device; the link ends that by itself, and sooner


class Life:
    """The signs of life of a node's threads. The time of its last sign decides about each thread.

    A thread with a loop calls `beat` in each round until its end. A thread that has died or hangs makes no
    more rounds. Code that other threads call works within `work`. `patience_s` is how long a sign is valid,
    in s.
    """

    def __init__(self, patience_s: float = PATIENCE_S) -> None:
        self.patience_s = patience_s
        self._signs: dict[int, tuple[str, float, float]] = {}  # thread -> (its task, since when, until when)

    def beat(self, what: str, most_s: float = 0.0) -> None:
        """Give a sign that the calling thread works.

        The thread must do so again within `most_s`, or within the usual time.
        """
        now_s = time.monotonic()
        self._signs[threading.get_ident()] = what, now_s, now_s + max(most_s, self.patience_s)

    def rest(self) -> None:
        """Give no more signs, because the calling thread ends as it should."""
        self._signs.pop(threading.get_ident(), None)

    def work(self, what: str, most_s: float = 0.0) -> Work:
        """Return a context manager for a task that must end within `most_s`, or within the usual time."""
        return Work(self, what, most_s)

    def doing(self) -> str:
        """Return the last known task of the calling thread, or "" without one."""
        sign = self._signs.get(threading.get_ident())
        return sign[0] if sign is not None else ""

    def trouble(self) -> str:
        """Return the task that has not moved on, or "" if all threads work."""
        now_s = time.monotonic()
        for what, since_s, until_s in list(self._signs.values()):
            if now_s > until_s:
                return f"{what} has not moved on for {now_s - since_s:.1f} s now"
        return ""


class Work:
    """A task of a thread. It must end within its block. After that, the task before it continues."""

    __slots__ = ("_life", "_most_s", "_outer", "_what")

    def __init__(self, life: Life, what: str, most_s: float) -> None:
        self._life, self._what, self._most_s = life, what, most_s

    def __enter__(self) -> None:
        self._outer = self._life.doing()
        self._life.beat(self._what, self._most_s)

    def __exit__(self, *_: object) -> None:
        if self._outer:
            self._life.beat(self._outer)
        else:
            self._life.rest()


class Watch:
    """Watches a node's life in a thread of its own, which never waits for anything else.

    While all threads work, `alive` is called. `hangs(trouble)` is called when a thread hangs, and with ""
    when it works again.
    """

    def __init__(self, life: Life, alive: Callable[[], None], hangs: Callable[[str], None]) -> None:
        self._life, self._alive, self._hangs = life, alive, hangs
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="unitylink-ros-life", daemon=True)
        self._thread.start()

    def _run(self) -> None:
        known = False
        while not self._stop.wait(LOOK_S):
            trouble = self._life.trouble()
            if bool(trouble) != known:
                known = bool(trouble)
                self._hangs(trouble)
            if not trouble:
                self._alive()

    def close(self) -> None:
        self._stop.set()
        self._thread.join()
