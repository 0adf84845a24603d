# SPDX-License-Identifier: BSD-3-Clause
"""Publishes for a device that cannot publish: a thread reads each group's words when they are due."""

from __future__ import annotations

import contextlib
import heapq
import os
import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from unitylink.errors import DeviceMismatch, LinkClosed, LinkError
from unitylink.protocol import GROUPS_MAX

from .engine import Times, Words


@dataclass
class _Group:
    """A subscription: what it reads, how often, and the publishes that wait."""

    addresses: tuple[int, ...]
    period_s: float
    ring: int
    waiting: deque[tuple[float, list[int]]] = field(default_factory=deque)
    lost: int = 0


class PolledPublishes:
    """The groups of one device. `read` returns the words at addresses, of one moment where it can.

    A late poll is skipped and counted as lost, and not made up for. Times are the middle of the read.
    """

    def __init__(self, read: Callable[[tuple[int, ...]], list[int]]) -> None:
        self.received = 0
        self.overruns = 0
        self._ended = 0
        self._read = read
        self._groups: dict[int, _Group] = {}
        self._due: list[tuple[float, int]] = []
        self._changed = threading.Condition()
        self._thread: threading.Thread | None = None
        self._generation = 0
        self._watchers: list[int] = []
        self._closed = False

    def add(self, addresses: tuple[int, ...], period_s: float, ring: int, group: int | None) -> int:
        """Begin to read `addresses` every `period_s`. Return the number of the subscription."""
        with self._changed:
            taken = {id % GROUPS_MAX for id, other in self._groups.items() if other.period_s}
            free = (number for number in range(GROUPS_MAX) if number not in taken)
            number = group if group is not None else next(free, -1)
            if number in taken or not 0 <= number < GROUPS_MAX:
                which = "all groups are" if group is None else f"group {group} is"
                raise DeviceMismatch(f"{which} in use: there are {GROUPS_MAX}, 0 to {GROUPS_MAX - 1}")
            for ended in [id for id in self._groups if id % GROUPS_MAX == number]:
                del self._groups[ended]  # nobody fetched what came before its end
            self._generation += 1
            identity = self._generation * GROUPS_MAX + number
            self._groups[identity] = _Group(addresses, period_s, ring)
            heapq.heappush(self._due, (time.monotonic() + period_s, identity))
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="unitylink polls", daemon=True)
                self._thread.start()
            self._changed.notify_all()
        return identity

    def remove(self, identity: int) -> None:
        """End a subscription. The publishes that have come can still be fetched."""
        with self._changed:
            group = self._groups.get(identity)
            if group is not None:
                group.period_s = 0.0
                self._ended += 1
                if not group.waiting:
                    del self._groups[identity]
            self._due = [entry for entry in self._due if entry[1] != identity]
            heapq.heapify(self._due)
            self._tell()

    def drain(self, identity: int, words: int) -> tuple[Times, Words]:
        with self._changed:
            group = self._groups.get(identity)
            rows = list(group.waiting) if group else []
            if group is not None:
                group.waiting.clear()
                if not group.period_s:
                    del self._groups[identity]
        times = np.array([time_s for time_s, _ in rows], dtype=np.float64)
        values = np.array([row for _, row in rows], dtype=np.uint32).reshape(len(rows), words)
        return times, values

    def take_single(self, identity: int) -> tuple[float, tuple[int, ...]] | None:
        with self._changed:
            group = self._groups.get(identity)
            if group is None or len(group.waiting) != 1:
                return None
            time_s, row = group.waiting.popleft()
            if not group.period_s:
                del self._groups[identity]
        return time_s, tuple(row)

    def subscribed(self, identity: int) -> bool:
        with self._changed:
            group = self._groups.get(identity)
            return group is not None and group.period_s > 0

    def available(self, identity: int) -> int:
        with self._changed:
            group = self._groups.get(identity)
            return len(group.waiting) if group else 0

    def lost(self, identity: int) -> int:
        with self._changed:
            group = self._groups.get(identity)
            return group.lost if group else 0

    def wait(self, identity: int, timeout_s: float) -> bool:
        """Wait for a publish. LinkClosed if none can come any more."""
        until = time.monotonic() + max(0.0, timeout_s)
        with self._changed:
            while True:
                group = self._groups.get(identity)
                if group is not None and group.waiting:
                    return True
                if self._closed:
                    raise LinkClosed("the link is closed")
                if group is None or not group.period_s:
                    raise LinkClosed("the subscription is closed")
                left = until - time.monotonic()
                if left <= 0:
                    return False
                self._changed.wait(left)

    def wait_for_news(self, seen: int, timeout_s: float) -> int:
        """Return the number of publishes and ended subscriptions, once it is no longer `seen`."""
        with self._changed:
            self._changed.wait_for(lambda: self.received + self._ended != seen or self._closed, timeout_s)
            return self.received + self._ended

    def watch(self, descriptor: int) -> None:
        """Write to an eventfd for each publish, and at the end."""
        with self._changed:
            self._watchers.append(descriptor)
            self._wake(descriptor)

    def forget(self, descriptor: int) -> None:
        with self._changed, contextlib.suppress(ValueError):
            self._watchers.remove(descriptor)

    def close(self) -> None:
        """End all subscriptions and the thread. Waiting callers get LinkClosed."""
        with self._changed:
            self._closed = True
            self._due.clear()
            self._tell()
            thread = self._thread
        if thread is not None and thread is not threading.current_thread():
            thread.join()

    def disown(self) -> None:
        """Forget the thread and the lock that it may have held. A forked child does not have that thread."""
        self._changed = threading.Condition()
        self._closed, self._thread = True, None
        self._due.clear()
        self._watchers.clear()

    def _run(self) -> None:
        while True:
            with self._changed:
                while not self._closed and (not self._due or self._due[0][0] > time.monotonic()):
                    self._changed.wait(self._due[0][0] - time.monotonic() if self._due else None)
                if self._closed:
                    return
                due, identity = heapq.heappop(self._due)
                group = self._groups[identity]
            started = time.monotonic()
            try:
                words = self._read(group.addresses)
            except LinkError:  # the memory was closed meanwhile: close() comes next
                return
            now = time.monotonic()
            with self._changed:
                if not group.period_s or self._closed:
                    continue
                if len(group.waiting) >= group.ring:
                    group.waiting.popleft()
                    group.lost += 1
                    self.overruns += 1
                group.waiting.append(((started + now) / 2, words))
                self.received += 1
                late = int(max(0.0, now - due) / group.period_s)
                group.lost += late
                heapq.heappush(self._due, (due + (late + 1) * group.period_s, identity))
                self._tell()

    def _tell(self) -> None:
        self._changed.notify_all()
        for descriptor in self._watchers:
            self._wake(descriptor)

    @staticmethod
    def _wake(descriptor: int) -> None:
        with contextlib.suppress(OSError):  # full, or its owner has just gone
            os.write(descriptor, (1).to_bytes(8, "little"))
