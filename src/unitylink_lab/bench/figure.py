# SPDX-License-Identifier: BSD-3-Clause
"""A figure: its limit, its measured value, and how it was measured."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from unitylink.errors import UnityLinkError


@dataclass(frozen=True)
class Figure:
    """One measured figure.

    `limit` is the required value. It is an upper bound if `at_most`, else a lower one. `details` are the
    absolute numbers behind it: name (with unit) to value. `complaint` says why the number does not count:
    messages were lost, or the source fell behind. Such a figure is not met, whatever its number. A
    `difference` is the difference of two measurements. Both vary by chance, so in a short run it may be below
    zero.

    >>> Figure("sync-read", "sync read over a bare round trip", 1.30, True, 1.12, "x").met
    True
    """

    name: str
    title: str
    limit: float
    at_most: bool
    measured: float
    unit: str
    details: Mapping[str, float] = field(default_factory=dict)
    complaint: str = ""
    difference: bool = False

    @property
    def met(self) -> bool:
        """Tell whether the figure reaches its limit."""
        within = self.measured <= self.limit if self.at_most else self.measured >= self.limit
        return within and not self.complaint

    @property
    def asked(self) -> str:
        """Return the limit as text."""
        return f"{'<=' if self.at_most else '>='} {number(self.limit)} {self.unit}"

    def to_json(self) -> dict[str, object]:
        """Return the figure for JSON."""
        return {
            "name": self.name,
            "title": self.title,
            "asked": self.limit,
            "direction": "at most" if self.at_most else "at least",
            "measured": self.measured,
            "unit": self.unit,
            "met": self.met,
            "complaint": self.complaint,
            "details": dict(self.details),
        }


@dataclass(frozen=True)
class Run:
    """The settings of one run of the bench.

    `quick` asks for the short form. It shows that the measurement works, but its numbers are rough.
    """

    quick: bool
    checkout: Path
    say: Callable[[str], None]

    def rounds(self, full: int, quick: int = 2) -> int:
        """Return how many rounds to make."""
        return quick if self.quick else full

    @property
    def build(self) -> Path:
        """The folder for the bench's files."""
        return self.checkout / "build" / "bench"


class BenchError(UnityLinkError):
    """A measurement could not be made. The message says what is missing or what went wrong."""


def number(value: float) -> str:
    """Return a number as people read it.

    >>> [number(v) for v in (1.3, 10, 612345.2, 0.07)]
    ['1.30', '10.0', '612,345', '0.07']
    """
    if abs(value) >= 1000:
        return f"{value:,.0f}"
    return f"{value:.1f}" if abs(value) >= 10 else f"{value:.2f}"
