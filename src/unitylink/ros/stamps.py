# SPDX-License-Identifier: BSD-3-Clause
"""Which time the stamps of messages have: that of this computer, or that of a board in steps."""

from __future__ import annotations

import time
from collections.abc import Callable

NS = 1_000_000_000


class Stamps:
    """Turns times of a link into stamps. By default, times are those of time.monotonic().

    >>> stamps = Stamps()
    >>> with_board = stamps.follow(lambda: 1.25)
    >>> stamps.now_s(), stamps.parts(1.5)
    (1.25, (1, 500000000))
    """

    def __init__(self) -> None:
        self._simulated: Callable[[], float] | None = None

    def follow(self, now_s: Callable[[], float] | None) -> None:
        """Take the time of a board in steps as it is. None: take that of this computer again."""
        self._simulated = now_s

    def now_s(self) -> float:
        """Return the time of now, in the time that is stamped."""
        return time.monotonic() if self._simulated is None else self._simulated()

    def parts(self, time_s: float) -> tuple[int, int]:
        """Return seconds and nanoseconds of a stamp."""
        offset_s = time.time() - time.monotonic() if self._simulated is None else 0.0
        return divmod(round((offset_s + time_s) * 1e9), NS)
