# SPDX-License-Identifier: BSD-3-Clause
"""How long the threads of a process wait for a processor, each time they want one. Linux tells it."""

from __future__ import annotations

import contextlib
from dataclasses import dataclass
from pathlib import Path

PROCESSES = Path("/proc")


@dataclass(frozen=True)
class Turns:
    """What all threads of a process have waited since they began, and how often they got a processor."""

    waited_ns: int = 0
    count: int = 0

    @classmethod
    def of(cls, pid: int) -> Turns:
        """Return those of a process. Nothing, if it is gone or the system does not tell."""
        waited_ns = count = 0
        for file in (PROCESSES / str(pid)).glob("task/*/schedstat"):
            with contextlib.suppress(OSError, ValueError):  # the thread has ended
                _, waited, turns = map(int, file.read_text("ascii").split())
                waited_ns, count = waited_ns + waited, count + turns
        return cls(waited_ns, count)

    def mean_wait_s(self, before: Turns) -> float:
        """Return how long a thread waited for each of its turns since `before`.

        >>> Turns(3_000_000_000, 130).mean_wait_s(Turns(1_000_000_000, 90))
        0.05
        """
        turns = self.count - before.count
        return max(0, self.waited_ns - before.waited_ns) / turns / 1e9 if turns > 0 else 0.0
