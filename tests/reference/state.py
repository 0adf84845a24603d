# SPDX-License-Identifier: BSD-3-Clause
"""What a device remembers in a session."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass
class Place:
    """What was last executed for the ids of one place. `reply` is None if it was too long to keep."""

    id: int
    status: int = 0
    empty: bool = True  # true while nothing has been executed here
    reply: bytes | None = b""


@dataclass
class Group:
    addresses: tuple[int, ...] = ()
    divisor: int = 0
    flags: int = 0
    sequence: int = 0


@dataclass(frozen=True)
class Exchange:
    outputs: tuple[tuple[int, int], ...]
    inputs: tuple[tuple[int, int], ...]
