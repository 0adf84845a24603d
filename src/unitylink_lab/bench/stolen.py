# SPDX-License-Identifier: BSD-3-Clause
"""Stolen time: the time in which the virtual machine was ready to run, but its host ran other machines."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

_STOLEN = 7  # the columns of proc(5) are: user nice system idle iowait irq softirq steal
_STAT = Path("/proc/stat")


@dataclass(frozen=True)
class ProcessorTime:
    """Ticks of all processors since the start of the system."""

    all: int
    stolen: int

    @classmethod
    def read(cls, stat: Path = _STAT) -> ProcessorTime | None:
        """Read the counters. The result is None if the system has none."""
        try:
            ticks = [int(text) for text in stat.read_text().splitlines()[0].split()[1:9]]
        except (OSError, ValueError, IndexError):
            return None
        return cls(sum(ticks), ticks[_STOLEN]) if len(ticks) > _STOLEN else None

    def stolen_percent(self, since: ProcessorTime) -> float:
        """Return the share of the time since `since` that the host took away.

        >>> ProcessorTime(300, 25).stolen_percent(since=ProcessorTime(100, 5))
        10.0
        """
        return 100 * (self.stolen - since.stolen) / max(1, self.all - since.all)
