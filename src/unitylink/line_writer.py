# SPDX-License-Identifier: BSD-3-Clause
"""Lines for a disk, a terminal or a pipe that may hang: a thread of its own writes them."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable


class LineWriter:
    """Writes lines in their order, so that nobody who has something to say waits for a reader.

    `put` writes one line. It has to handle its own errors. If `most` lines wait, the oldest of them is left
    out for each new one: what happened last is what somebody looks for. `left_out` counts these lines. Before
    the next line is written, `tell_left_out` is called with how many are missing there.

    >>> writer = LineWriter(print, most=1000, tell_left_out=lambda count: print(f"{count} lines left out"))
    >>> writer.write("up")
    >>> writer.close(within_s=20.0)
    up
    """

    def __init__(
        self, put: Callable[[str], object], *, most: int, tell_left_out: Callable[[int], object]
    ) -> None:
        self._put, self._most, self._tell_left_out = put, most, tell_left_out
        self.left_out = 0
        self._told = 0  # of those that are left out
        self._changed = threading.Condition()  # guards all that changes
        self._waiting: deque[str] = deque()
        self._closed = False
        self._thread = threading.Thread(target=self._work, name="line writer", daemon=True)
        self._thread.start()

    def write(self, line: str) -> None:
        """Take a line, from any thread, and return at once. After `close`, this does nothing."""
        with self._changed:
            if self._closed:
                return
            if len(self._waiting) == self._most:
                self._waiting.popleft()
                self.left_out += 1
            self._waiting.append(line)
            self._changed.notify()

    def close(self, within_s: float) -> None:
        """Take no more lines, and wait until those that wait are written, or the time is over."""
        with self._changed:
            self._closed = True
            self._changed.notify()
        self._thread.join(within_s)

    def _work(self) -> None:
        while True:
            with self._changed:
                self._changed.wait_for(lambda: self._waiting or self._closed)
                if not self._waiting:
                    return
                line = self._waiting.popleft()
                left_out, self._told = self.left_out - self._told, self.left_out
            if left_out:
                self._tell_left_out(left_out)
            self._put(line)
