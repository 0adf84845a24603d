# SPDX-License-Identifier: BSD-3-Clause
"""What was executed for a client: each request at most once, however often it comes. No I/O, no clock."""

from __future__ import annotations

from enum import Enum
from typing import Generic, TypeVar

T = TypeVar("T")
OPEN_MAX = 256  # requests of one client that may still come again


class Verdict(Enum):
    """What to do with a request: execute it, wait for its first copy, or refuse it."""

    NEW = "new"
    RUNNING = "running"
    SETTLED = "settled"  # the client has said that it will not come again
    FULL = "full"


class Ledger(Generic[T]):
    """The requests of one client by their ids, with the answers that were given.

    >>> ledger = Ledger()
    >>> ledger.begin(1, settled=1)
    <Verdict.NEW: 'new'>
    >>> ledger.begin(1, settled=1)
    <Verdict.RUNNING: 'running'>
    >>> ledger.finish(1, b"done")
    >>> ledger.begin(1, settled=1)
    b'done'
    """

    def __init__(self) -> None:
        self._answers: dict[int, T | None] = {}
        self._settled = 0
        self.repeated = 0  # requests that came again

    def begin(self, number: int, settled: int) -> Verdict | T:
        """Return the answer that was given before, or what to do.

        After NEW, `finish` must follow.
        """
        if settled > self._settled:
            self._settled = settled
            for old in [one for one in self._answers if one < settled and self._answers[one] is not None]:
                del self._answers[old]
        if number in self._answers:
            self.repeated += 1
            answer = self._answers[number]
            return Verdict.RUNNING if answer is None else answer
        if number < self._settled:
            self.repeated += 1
            return Verdict.SETTLED
        if len(self._answers) >= OPEN_MAX:
            return Verdict.FULL
        self._answers[number] = None
        return Verdict.NEW

    def finish(self, number: int, answer: T) -> None:
        """Keep the answer, until the client says that it has it."""
        if number < self._settled:
            del self._answers[number]  # the client has given up meanwhile
        else:
            self._answers[number] = answer
