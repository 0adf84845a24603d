# SPDX-License-Identifier: BSD-3-Clause
"""Write leases: at any time, one user at most writes a part of the robot.

A lease ends in one of two ways. Its holder releases it or hands it over: then the outputs keep their values.
Or it is lost, because its time is over, the holder's connection is gone, or an administrator breaks it. Then
nobody can have the part before its outputs are safe: the lease is *ending* until `made_safe`. The model is
the locking service of OPC UA for devices (OPC 10000-100, InitLock to BreakLock).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, replace

from unitylink.errors import LeaseHeld, ValueRangeError

from .subtree import contains, overlap, shown

DURATION_MIN_S, DURATION_MAX_S = 0.05, 3600.0


@dataclass(frozen=True)
class Lease:
    """The right to write `part`.

    `client` is the holder's connection, and `holder` the name of its user. `until_s` is when the lease ends
    unless it is renewed. `ending` is "" or the reason why the outputs are being made safe.
    """

    part: str
    client: int
    holder: str
    until_s: float
    duration_s: float
    ending: str = ""


class Leases:
    """All leases of one robot. Times are in s, of any clock that does not jump. They are always given.

    >>> leases = Leases()
    >>> leases.take("j1", client=1, holder="ana", duration_s=2.0, now_s=0.0).until_s
    2.0
    >>> leases.take("", client=2, holder="ben", duration_s=2.0, now_s=0.5)
    Traceback (most recent call last):
    unitylink.errors.LeaseHeld: ana holds the write lease of j1, for 1.5 s more unless it is renewed
    >>> leases.expire(now_s=2.0)
    >>> [lease.part for lease in leases.ending()]  # the server now makes these safe
    ['j1']
    >>> leases.made_safe("j1")
    >>> leases.take("", client=2, holder="ben", duration_s=2.0, now_s=2.1).part
    ''
    """

    def __init__(self) -> None:
        self._leases: dict[str, Lease] = {}

    def all(self) -> tuple[Lease, ...]:
        """Return the leases that are held or ending, by name of their part."""
        return tuple(self._leases[part] for part in sorted(self._leases))

    def take(self, part: str, *, client: int, holder: str, duration_s: float, now_s: float) -> Lease:
        """Give a lease, or renew one that the same client has.

        Leases of this client within `part` become one with it. Raises LeaseHeld if another one has a lease
        on a part that overlaps, and ValueRangeError for a duration that cannot be.
        """
        duration_s = _duration(duration_s)
        self.expire(now_s)  # a lease whose time is over is lost, whether or not anybody has looked
        mine = []
        for lease in self.all():
            if not overlap(lease.part, part):
                continue
            if lease.client != client or lease.ending:
                raise LeaseHeld(self._reason(lease, now_s))
            mine.append(lease)
        if outer := next((lease for lease in mine if contains(lease.part, part)), None):
            part = outer.part
        for lease in mine:
            del self._leases[lease.part]
        self._leases[part] = Lease(part, client, holder, now_s + duration_s, duration_s)
        return self._leases[part]

    def renew(self, client: int, now_s: float) -> tuple[Lease, ...]:
        """Renew all leases of a client. Return them."""
        self.expire(now_s)  # a lease whose time is over is lost, whether or not anybody has looked
        for lease in self.of(client):
            self._leases[lease.part] = replace(lease, until_s=now_s + lease.duration_s)
        return self.of(client)

    def of(self, client: int) -> tuple[Lease, ...]:
        """Return the leases that a client holds. Those that end are not among them."""
        return tuple(lease for lease in self.all() if lease.client == client and not lease.ending)

    def holder(self, path: str) -> Lease | None:
        """Return the lease in which the item at `path` is, or None."""
        return next((lease for lease in self.all() if contains(lease.part, path)), None)

    def may_write(self, client: int, path: str, now_s: float) -> bool:
        """Tell whether the lease of `path` is this client's, and still runs."""
        lease = self.holder(path)
        return lease is not None and lease.client == client and not lease.ending and now_s < lease.until_s

    def release(self, client: int, part: str) -> None:
        """Give a lease back. The outputs keep their values. Nothing happens if it is not this client's."""
        lease = self._leases.get(part)
        if lease is not None and lease.client == client and not lease.ending:
            del self._leases[part]

    def hand_over(self, part: str, *, client: int, to: int, holder: str, now_s: float) -> Lease:
        """Give a lease to another client. The outputs keep their values.

        Raises LeaseHeld if this client does not hold it.
        """
        self.expire(now_s)  # a lease whose time is over is lost, whether or not anybody has looked
        lease = self._leases.get(part)
        if lease is None or lease.client != client or lease.ending:
            raise LeaseHeld(
                self._reason(lease, now_s) if lease else f"nobody holds the write lease of {shown(part)}"
            )
        self._leases[part] = replace(lease, client=to, holder=holder, until_s=now_s + lease.duration_s)
        return self._leases[part]

    def expire(self, now_s: float) -> None:
        """End the leases whose time is over."""
        self._end((lease for lease in self.all() if now_s >= lease.until_s), "its time was over")

    def lose(self, client: int, reason: str = "its connection ended") -> None:
        """End all leases of a client that is gone."""
        self._end(self.of(client), reason)

    def break_up(self, part: str, by: str) -> None:
        """End all leases that overlap a part, as an administrator may."""
        self._end((lease for lease in self.all() if overlap(lease.part, part)), f"{by} broke it")

    def made_safe(self, part: str) -> None:
        """Say that the outputs of an ending lease are safe. Others can have the part from now on."""
        lease = self._leases.get(part)
        if lease is not None and lease.ending:
            del self._leases[part]

    def ending(self) -> tuple[Lease, ...]:
        """Return the leases whose parts are not safe yet: the server has to make them safe."""
        return tuple(lease for lease in self.all() if lease.ending)

    def _end(self, leases: Iterable[Lease], reason: str) -> None:
        for lease in leases:
            if not lease.ending:
                self._leases[lease.part] = replace(lease, ending=reason)

    @staticmethod
    def _reason(lease: Lease, now_s: float) -> str:
        if lease.ending:
            return (
                f"{shown(lease.part)} is being made safe, because {lease.holder} lost its write lease "
                f"({lease.ending}); try again in a moment"
            )
        left_s = max(0.0, lease.until_s - now_s)
        return (
            f"{lease.holder} holds the write lease of {shown(lease.part)}, for {left_s:.3g} s more unless "
            "it is renewed"
        )


def _duration(duration_s: float) -> float:
    if not (math.isfinite(duration_s) and DURATION_MIN_S <= duration_s <= DURATION_MAX_S):
        raise ValueRangeError(
            f"a lease of {duration_s:g} s; expected {DURATION_MIN_S:g} to {DURATION_MAX_S:g} s"
        )
    return float(duration_s)
