# SPDX-License-Identifier: BSD-3-Clause
"""Who has asked for a lease that another one holds, and for whom a part is kept that was given back."""

from __future__ import annotations

from dataclasses import dataclass

from unitylink.errors import LeaseHeld

from .subtree import overlap, shown

ASKED_S = 60.0  # a question stands so long
KEPT_S = 10.0  # a part that was given to somebody is kept so long


@dataclass(frozen=True)
class Wish:
    """A user wants the lease of `part`. If it is `kept`, nobody else can take it until then."""

    part: str
    user: str
    until_s: float
    kept: bool = False


class Wishes:
    """The wishes of one robot. Times are in s, of a clock that does not jump.

    >>> wishes = Wishes()
    >>> wishes.ask("j1", "ben", now_s=0.0)
    >>> wishes.keep("j1", "", now_s=1.0)  # for who has asked first
    'ben'
    >>> wishes.check("j1.target", "cem", now_s=2.0)
    Traceback (most recent call last):
    unitylink.errors.LeaseHeld: j1 is kept for ben, for 9 s more
    >>> wishes.check("j1.target", "ben", now_s=3.0)
    >>> wishes.taken("j1", "ben")
    >>> wishes.all(now_s=3.0)
    ()
    """

    def __init__(self) -> None:
        self._wishes: list[Wish] = []

    def all(self, now_s: float) -> tuple[Wish, ...]:
        """Return the wishes that still stand, the oldest first."""
        self._wishes = [wish for wish in self._wishes if now_s < wish.until_s]
        return tuple(self._wishes)

    def ask(self, part: str, user: str, now_s: float) -> None:
        """Note that a user wants a part. Asking again renews it, and keeps its place."""
        wish = Wish(part, user, now_s + ASKED_S)
        for place, other in enumerate(self.all(now_s)):
            if (other.part, other.user) == (part, user) and not other.kept:
                self._wishes[place] = wish
                return
        self._wishes.append(wish)

    def keep(self, part: str, user: str, now_s: float) -> str:
        """Keep a part for a user, or for who has asked first. Return that user, or "" if nobody has asked."""
        asked = [wish.user for wish in self.all(now_s) if overlap(wish.part, part) and not wish.kept]
        user = user or next(iter(asked), "")
        if user:
            self.taken(part, user)
            self._wishes.append(Wish(part, user, now_s + KEPT_S, kept=True))
        return user

    def check(self, part: str, user: str, now_s: float) -> None:
        """Raises LeaseHeld if the part is kept for somebody else."""
        for wish in self.all(now_s):
            if wish.kept and wish.user != user and overlap(wish.part, part):
                raise LeaseHeld(
                    f"{shown(wish.part)} is kept for {wish.user}, for {wish.until_s - now_s:.3g} s more"
                )

    def taken(self, part: str, user: str) -> None:
        """Note that a user has got a part, so he wants it no more."""
        self._wishes = [wish for wish in self._wishes if not (wish.user == user and overlap(wish.part, part))]
