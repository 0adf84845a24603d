# SPDX-License-Identifier: BSD-3-Clause
"""Publishes of the board as publications: each group of words once, for all who want the same."""

from __future__ import annotations

import itertools
import logging
import threading
import time
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from unitylink.errors import ProtocolError, UnityLinkError

from ..messages import encode_samples

if TYPE_CHECKING:
    import zenoh

    from unitylink.layer2_message import Link, Subscription
    from unitylink.layer2_message.native_link import Times, Words

GATHER_S = 0.001  # a fast stream wakes the bridge so often at most
_CLOSE_NS = 1_000_000  # between the time of a link and that of the system: then they are the same
Put = Callable[[bytes], Any]
Body = Callable[["Words"], bytes]
_Wanted = tuple[tuple[int, ...], int, bool, "int | None"]
_log = logging.getLogger("unitylink.zenoh")


def raw_words(words: Words) -> bytes:
    """Return the bytes of all rows, one after the other: their words, little-endian."""
    return np.asarray(words, dtype="<u4").tobytes()


class Output:
    """Where the rows of a group go: `put` takes the message of each.

    `body` returns the bytes of rows of words, one after the other, `row_bytes` for each.
    """

    def __init__(self, put: Put, body: Body, row_bytes: int) -> None:
        self._put, self._body, self._row_bytes = put, body, row_bytes

    def send(self, first: int, times: Times, since_ns: int, words: Words) -> None:
        """Put a message for each row. `first` is the sequence of the first one.

        The time of a message is that in `times`, in ns, and `since_ns` later.
        """
        data = self._body(words)
        if len(data) != self._row_bytes * len(times):
            raise ProtocolError(f"{len(data)} bytes for {len(times)} publishes of {self._row_bytes} bytes")
        put = self._put
        for message in encode_samples(first, times, since_ns, data):
            put(message)


class Group:
    """One subscription at the board, and the publications that are made of it."""

    def __init__(self, wanted: _Wanted, publisher: zenoh.Publisher) -> None:
        self.wanted = wanted
        self._publisher = publisher
        self.users: set[int] = set()  # visits, and 0 for the topic
        self.outputs: tuple[Output, ...] = (Output(publisher.put, raw_words, 4 * len(wanted[0])),)
        self.subscription: Subscription | None = None
        self.published = 0
        self._link: Link | None = None

    def start(self, link: Link, *, verify: bool) -> None:
        """Subscribe at the board. Raises LinkError."""
        addresses, divisor, on_event, group = self.wanted
        self._link = link
        self.subscription = link.subscribe(
            addresses, divisor=divisor, on_event=on_event, verify=verify, group=group
        )
        self.subscription.on_publish(self._one, gather_s=GATHER_S, arrays=self._many)

    def stop(self) -> None:
        """End the subscription, then the publisher: Zenoh refuses to end it while something is put."""
        if self.subscription is not None:
            try:
                self.subscription.close()
            except UnityLinkError as error:  # the board is away, and has forgotten it
                _log.debug("a group was not released: %s", error)
        self._publisher.undeclare()

    def _one(self, time_s: float, words: Sequence[int]) -> None:
        self._many(np.array([time_s]), np.array([words], dtype=np.uint32))

    def _many(self, times: Times, words: Words) -> bool:
        link, subscription = self._link, self.subscription
        if link is None or subscription is None:
            return True
        first = self.published + subscription.missing + subscription.lost
        self.published += len(times)
        since_ns = time.monotonic_ns() - int(link.now_s() * 1e9)
        if abs(since_ns) < _CLOSE_NS:
            since_ns = 0
        for output in self.outputs:
            try:
                output.send(first, times, since_ns, words)
            except Exception as error:  # the session ends, or the board holds what its type does not have
                _log.debug("a publish was left out: %s", error)
        return True


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
        topic: Output | None = None,
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
                try:
                    one.start(self._link(), verify=verify)
                except BaseException:
                    one.stop()
                    raise
                self._groups[number] = one
            one = self._groups[number]
            if topic is not None:
                one.outputs = (*one.outputs, topic)
            one.users.add(user)
            return number

    def leave(self, number: int, user: int) -> None:
        """A user does not want a group any more. The last one ends it."""
        with self._lock:
            one = self._groups.get(number)
            if one is None:
                return
            one.users.discard(user)
            if user == 0:
                one.outputs = one.outputs[:1]
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
