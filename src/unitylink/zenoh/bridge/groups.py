# SPDX-License-Identifier: BSD-3-Clause
"""Publishes of the board as publications: each group of words once, for all who want the same."""

from __future__ import annotations

import itertools
import logging
import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

from unitylink._native import PublishPath, SampleOutput
from unitylink.errors import UnityLinkError

if TYPE_CHECKING:
    import zenoh

    from unitylink.layer2_message import Link, Subscription

GATHER_S = 0.001  # a fast stream wakes the bridge so often at most
Put = Callable[[bytearray], Any]
_Wanted = tuple[tuple[int, ...], int, bool, "int | None"]
_log = logging.getLogger("unitylink.zenoh")


class Group:
    """One subscription at the board, and the publications that are made of it."""

    def __init__(self, wanted: _Wanted, publisher: zenoh.Publisher) -> None:
        self.wanted = wanted
        self._publisher = publisher
        self._words = SampleOutput(publisher.put, len(wanted[0]))  # for the links of our clients
        self._topics: tuple[SampleOutput, ...] = ()
        self._path = PublishPath(_left_out)
        self.users: set[int] = set()  # visits, and 0 for the topic
        self.subscription: Subscription | None = None

    def start(self, link: Link, *, verify: bool) -> None:
        """Subscribe at the board. Raises LinkError."""
        addresses, divisor, on_event, group = self.wanted
        self.subscription = link.subscribe(
            addresses, divisor=divisor, on_event=on_event, verify=verify, group=group
        )
        self.subscription.hand_over(self._path.take, gather_s=GATHER_S)

    def stop(self) -> None:
        """End the subscription, then the publisher: Zenoh refuses to end it while something is put."""
        if self.subscription is not None:
            try:
                self.subscription.close()
            except UnityLinkError as error:  # the board is away, and has forgotten it
                _log.debug("a group was not released: %s", error)
        self._publisher.undeclare()

    def add(self, user: int, topic: SampleOutput | None) -> None:
        """Let a user have it. The user 0 has a `topic` instead of the words."""
        self.users.add(user)
        if topic is not None:
            self._topics = (*self._topics, topic)
        self._choose()

    def drop(self, user: int) -> None:
        """A user does not want it any more."""
        self.users.discard(user)
        if user == 0:
            self._topics = ()
        self._choose()

    def _choose(self) -> None:
        """Put each message that somebody wants, and no other."""
        self._path.outputs = (self._words, *self._topics) if self.users - {0} else self._topics

    @property
    def published(self) -> int:
        """How many publishes of the board have come."""
        return self._path.published


def _left_out(error: object) -> None:
    """The session ends."""
    _log.debug("publishes were left out: %s", error)


class Groups:
    """The groups of a board. `publisher(number)` returns what publishes the words of a group."""

    def __init__(self, link: Callable[[], Link], publisher: Callable[[int], zenoh.Publisher]) -> None:
        self._link, self._publisher = link, publisher
        self._lock = threading.Lock()
        self._numbers = itertools.count(1)
        self._groups: dict[int, Group] = {}
        self._ended = 0  # publishes of groups that have ended

    def join(
        self,
        user: int,
        addresses: tuple[int, ...],
        *,
        divisor: int,
        on_event: bool = False,
        verify: bool = True,
        group: int | None = None,
        topic: SampleOutput | None = None,
    ) -> int:
        """Let a user have a group. Return its number. Raises LinkError, for example if no group is free."""
        wanted = (addresses, divisor, on_event, group)
        with self._lock:
            same = (
                number
                for number, one in self._groups.items()
                if one.wanted == wanted or (group is None and one.wanted[:3] == wanted[:3])
            )
            number = next(same, 0)
            if not number:
                number = next(self._numbers)
                one = Group(wanted, self._publisher(number))
                one.add(user, topic)  # before the first publish
                try:
                    one.start(self._link(), verify=verify)
                except BaseException:
                    one.stop()
                    raise
                self._groups[number] = one
            else:
                self._groups[number].add(user, topic)
            return number

    def leave(self, number: int, user: int) -> None:
        """A user does not want a group any more. The last one ends it."""
        with self._lock:
            one = self._groups.get(number)
            if one is None:
                return
            one.drop(user)
            if one.users:
                return
            del self._groups[number]
            self._ended += one.published
        one.stop()

    def clear(self) -> None:
        """End all: the board was lost."""
        with self._lock:
            groups, self._groups = self._groups, {}
            self._ended += sum(one.published for one in groups.values())
        for one in groups.values():
            one.stop()

    @property
    def published(self) -> int:
        """How many publishes of the board have come."""
        with self._lock:
            return self._ended + sum(one.published for one in self._groups.values())
