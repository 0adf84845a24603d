# SPDX-License-Identifier: BSD-3-Clause
"""The clients of a bridge: each has a number, rights at the gate, and a ledger of its requests. No I/O."""

from __future__ import annotations

import secrets
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from unitylink.errors import LinkBusy

from .ledger import Ledger

if TYPE_CHECKING:
    from unitylink.server.gate import Client

VISITS_MAX = 256
UNKNOWN = "this bridge does not know the client (any more); it has to say hello again"
GRACE_NS = 3_000_000_000  # how long a visit lasts whose token has not been seen


@dataclass
class Visit:
    """One client. `name` is that of its token. `present` says whether the token is there."""

    number: int
    name: str
    client: Client
    came_ns: int
    present: bool = False
    ledger: Ledger[bytes] = field(default_factory=Ledger)
    groups: set[int] = field(default_factory=set)


class Visits:
    """Who is there. The numbers are random, so no bridge takes what was meant for another.

    Hold one lock around all calls.
    """

    def __init__(self) -> None:
        self._visits: dict[int, Visit] = {}
        self._tokens: set[str] = set()  # of clients that are there, whether they visit us or not

    def add(self, name: str, client: Client, now_ns: int) -> Visit:
        """Let a client in. Raises LinkBusy if there are too many."""
        if len(self._visits) >= VISITS_MAX:
            raise LinkBusy(f"{VISITS_MAX} clients are there, which is all; close one, and try again")
        number = secrets.randbits(52) | 1  # exact as a number of JavaScript, too
        visit = Visit(number, name, client, now_ns, name in self._tokens)
        self._visits[number] = visit
        return visit

    def get(self, number: int) -> Visit | None:
        """Return a visit by its number."""
        return self._visits.get(number)

    def remove(self, number: int) -> None:
        """Let a client go."""
        self._visits.pop(number, None)

    def all(self) -> tuple[Visit, ...]:
        """Return who is there."""
        return tuple(self._visits.values())

    def token(self, name: str, present: bool) -> tuple[Visit, ...]:
        """Note that a token came or went. Return the visits that have ended by that."""
        (self._tokens.add if present else self._tokens.discard)(name)
        mine = [one for one in self.all() if one.name == name]
        for visit in mine:
            ended = visit.present and not present
            visit.present = present
            if ended:
                self.remove(visit.number)
        return () if present else tuple(one for one in mine if one.number not in self._visits)

    def absent(self, now_ns: int) -> tuple[Visit, ...]:
        """Remove and return the visits whose token has never been seen, and that are not new."""
        late = [one for one in self.all() if not one.present and now_ns - one.came_ns > GRACE_NS]
        for visit in late:
            self.remove(visit.number)
        return tuple(late)

    def alive(self, wanted: Callable[[Visit], None]) -> None:
        """Call `wanted` for each visit whose token is there."""
        for visit in self.all():
            if visit.present:
                wanted(visit)
