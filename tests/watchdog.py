# SPDX-License-Identifier: BSD-3-Clause
"""Ends a run in which a test hangs, with the stacks of all threads.

The interpreter's own watchdog needs neither a thread of Python nor the interpreter's lock, so it also ends a
test that hangs in C++. To arm it takes as long as a short test does. So it gets a little more time, and is
armed again only when that is used up.
"""

from __future__ import annotations

import faulthandler
import time

HANG_S = 900.0  # the slowest test, with what it builds, takes two minutes
MORE = 1 / 15  # of that


class Watchdog:
    """Watches the tests of one process, one after another."""

    def __init__(self, stderr: int) -> None:
        self._stderr = stderr
        self._ends_s = 0.0  # when the armed watchdog ends the process

    def watch(self, hang_s: float = HANG_S) -> None:
        """Give the test that begins `hang_s` seconds, and a little more."""
        now_s, most_s = time.monotonic(), hang_s * (1 + MORE)
        if not hang_s <= self._ends_s - now_s <= most_s:
            faulthandler.dump_traceback_later(most_s, file=self._stderr, exit=True)
            self._ends_s = now_s + most_s

    def disarmed(self) -> None:
        """Somebody else has disarmed it, so it is armed for the next test."""
        self._ends_s = 0.0
