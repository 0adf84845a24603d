# SPDX-License-Identifier: BSD-3-Clause
"""The publishes that a client has subscribed to: rings of samples, and who waits for them. No I/O."""

from __future__ import annotations

import logging
import threading
import time
from collections import deque
from dataclasses import dataclass, field

import numpy as np

from unitylink.errors import LinkClosed, ProtocolError, UnityLinkError
from unitylink.layer2_message.native_link import Times, Words

from .messages import decode_sample

_HALF = 1 << 31
_log = logging.getLogger("unitylink.zenoh")


@dataclass
class FarGroup:
    """One subscription. `number` is that of the bridge, which is another one after the bridge came back.

    `refused` is why the board that came back does not publish it.
    """

    addresses: tuple[int, ...]
    divisor: int
    flags: int
    detail: int
    rows: deque[tuple[float, tuple[int, ...]]]
    number: int = 0
    open: bool = True
    refused: UnityLinkError | None = None
    expected: int | None = None
    lost: int = 0
    missing: int = 0
    undo: list[object] = field(default_factory=list)

    def take(self, data: bytes, offset_ns: int) -> None:
        """Take a publication. Raises ProtocolError if it is none."""
        sequence, time_ns, words = decode_sample(data, len(self.addresses))
        if self.expected is not None:
            gap = (sequence - self.expected) & 0xFFFFFFFF
            if gap >= _HALF:
                raise ProtocolError("a publication that is older than the last one")
            self.missing += gap
        self.expected = (sequence + 1) & 0xFFFFFFFF
        if len(self.rows) == self.rows.maxlen:
            self.lost += 1
        self.rows.append(((time_ns + offset_ns) / 1e9, words))


class FarGroups:
    """All subscriptions of a link, with a condition for those who wait for news."""

    def __init__(self) -> None:
        self.news = threading.Condition()
        self.count = 0  # of news
        self.ended = ""
        self._groups: dict[int, FarGroup] = {}
        self._next = 1

    def add(self, group: FarGroup) -> int:
        """Return the number by which layer 2 knows the group."""
        with self.news:
            number, self._next = self._next, self._next + 1
            self._groups[number] = group
            return number

    def get(self, number: int) -> FarGroup:
        """Return a group."""
        return self._groups[number]

    def open(self) -> list[FarGroup]:
        """Return the groups that have not been closed."""
        with self.news:
            return [one for one in self._groups.values() if one.open]

    def tell(self) -> None:
        """Wake whoever waits."""
        with self.news:
            self.count += 1
            self.news.notify_all()

    def refuse(self, number: int, error: UnityLinkError) -> str:
        """The board that came back does not publish it. Whoever waits for it is told why. Return that."""
        text = f"the subscription has ended, for the board that came back refuses it: {error}"
        with self.news:
            group = self._groups[number]
            group.open, group.refused = False, type(error)(text)
        _log.error("no more callbacks: %s", text)
        self.tell()
        return text

    def end(self, why: str) -> None:
        """Nothing comes any more."""
        self.ended = why
        self.tell()

    def drain(self, number: int, words: int) -> tuple[Times, Words]:
        """Take all that has come, oldest first."""
        with self.news:
            rows = list(self._groups[number].rows)
            self._groups[number].rows.clear()
        times = np.array([time_s for time_s, _ in rows], dtype=np.float64)
        return times, np.array([row for _, row in rows], dtype=np.uint32).reshape(len(rows), words)

    def take_single(self, number: int) -> tuple[float, tuple[int, ...]] | None:
        """Take the only publish that has come, or none if there are more."""
        with self.news:
            rows = self._groups[number].rows
            return rows.popleft() if len(rows) == 1 else None

    def wait(self, number: int, timeout_s: float) -> bool:
        """Wait for a publish of a group. Raises LinkClosed, or what it was refused with, if none can come."""
        group = self._groups[number]
        with self.news:
            until = time.monotonic() + timeout_s
            while not group.rows:
                if group.refused is not None:
                    raise type(group.refused)(str(group.refused))
                if self.ended or not group.open:
                    raise LinkClosed(self.ended or "the subscription is closed")
                left_s = until - time.monotonic()
                if left_s <= 0:
                    return False
                self.news.wait(left_s)
            return True

    def wait_news(self, seen: int, timeout_ns: int) -> int:
        """Wait until there is other news than `seen`. Return the number of the newest."""
        with self.news:
            self.news.wait_for(lambda: self.count != seen or bool(self.ended), timeout_ns / 1e9)
            return self.count
