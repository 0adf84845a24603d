# SPDX-License-Identifier: BSD-3-Clause
"""The parts of a bound: the gateware, a message in the way, and the result."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol


class Gateware(Protocol):
    """What must be known about the gateware. A BoardConfiguration has all of this."""

    @property
    def protocol(self) -> str: ...
    @property
    def address_bits(self) -> int: ...
    @property
    def data_bits(self) -> int: ...
    @property
    def clock_hz(self) -> int: ...
    @property
    def groups(self) -> int: ...
    @property
    def group_size(self) -> int: ...
    @property
    def read_many(self) -> int: ...
    @property
    def rate_bytes(self) -> int: ...
    @property
    def publish_mode(self) -> int: ...
    @property
    def datalink(self) -> str: ...
    @property
    def checksum(self) -> str: ...
    @property
    def byte_clocks(self) -> int: ...
    @property
    def engine(self) -> str: ...


@dataclass(frozen=True)
class Occupation:
    """The cost of a message: clocks of the application, and bytes on the line. `name` is its command."""

    name: str
    clocks: int
    characters: int


@dataclass(frozen=True)
class Isochrony:
    """Clocks from base strobe to first bus strobe: `idle_clocks` when idle, and at most `late_clocks` more.

    `longest` is the message that can delay a publish for the longest time.
    """

    idle_clocks: int
    late_clocks: int
    longest: Occupation
    clock_hz: int

    @property
    def bound_clocks(self) -> int:
        return self.idle_clocks + self.late_clocks

    @property
    def idle_s(self) -> float:
        return self.idle_clocks / self.clock_hz

    @property
    def late_s(self) -> float:
        return self.late_clocks / self.clock_hz
