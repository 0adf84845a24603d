# SPDX-License-Identifier: BSD-3-Clause
"""Who is told of a publish; what a callback raises is reported, and stops nobody else."""

from __future__ import annotations

import asyncio
import logging
import threading
from collections import deque
from collections.abc import AsyncIterator, Callable
from typing import Generic, TypeVar

logger = logging.getLogger("unitylink.publishing")

T = TypeVar("T")

STREAM_LIMIT = 65_536  # publishes kept for an `async for` that does not keep up
ALIVE_CHECK_S = 0.2  # how soon an `async for` notices that nothing can come any more


class Listeners(Generic[T]):
    """The callbacks of one value or group."""

    def __init__(self, item: str) -> None:
        self._item = item
        self._lock = threading.Lock()  # of who comes and goes; telling needs none: tuples are replaced
        self._publish: tuple[Callable[[float, T], object], ...] = ()
        self._change: tuple[Callable[[T], object], ...] = ()
        self.previous: object = None  # what was published last: nothing yet
        self.heard = False
        """Whether somebody wants to hear of each publish; who does not ask `tell` then keeps `previous`."""

    def on_publish(self, callback: Callable[[float, T], object]) -> Callable[[], None]:
        with self._lock:
            self._publish += (callback,)
            self.heard = True

        def remove() -> None:
            with self._lock:
                self._publish = tuple(c for c in self._publish if c is not callback)
                self.heard = bool(self._publish or self._change)

        return remove

    def on_change(self, callback: Callable[[T], object]) -> Callable[[], None]:
        with self._lock:
            self._change += (callback,)
            self.heard = True

        def remove() -> None:
            with self._lock:
                self._change = tuple(c for c in self._change if c is not callback)
                self.heard = bool(self._publish or self._change)

        return remove

    async def stream(self, alive: Callable[[], bool]) -> AsyncIterator[tuple[float, T]]:
        """Yield (time_s, value) of every publish, from any thread, until `alive` says that none can come."""
        loop = asyncio.get_running_loop()
        waiting: deque[tuple[float, T]] = deque(maxlen=STREAM_LIMIT)
        arrived = asyncio.Event()

        def take(time_s: float, value: T) -> None:
            if len(waiting) == STREAM_LIMIT:
                logger.warning("%s: a publish was lost, its reader is too slow", self._item)
            waiting.append((time_s, value))
            loop.call_soon_threadsafe(arrived.set)

        remove = self.on_publish(take)
        try:
            while waiting or alive():
                while waiting:
                    yield waiting.popleft()
                try:
                    await asyncio.wait_for(arrived.wait(), ALIVE_CHECK_S)
                except asyncio.TimeoutError:
                    continue
                arrived.clear()
        finally:
            remove()

    def tell(self, time_s: float, value: T) -> None:
        for publish in self._publish:
            try:
                publish(time_s, value)
            except Exception:
                self._report(publish)
        if self._change and value != self.previous:
            for change in self._change:
                try:
                    change(value)
                except Exception:
                    self._report(change)
        self.previous = value

    def _report(self, callback: object) -> None:
        logger.exception("%s: the callback %r raised; publishing goes on", self._item, callback)
