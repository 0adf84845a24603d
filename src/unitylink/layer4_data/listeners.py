# SPDX-License-Identifier: BSD-3-Clause
"""The callbacks of a publish. An exception in one is reported and does not stop the others."""

from __future__ import annotations

import asyncio
import logging
import threading
from collections import deque
from collections.abc import AsyncIterator, Callable
from functools import partial
from typing import Generic, TypeVar
from weakref import finalize

from unitylink.errors import LinkClosed, ValueRangeError, shown

logger = logging.getLogger("unitylink.publishing")

T = TypeVar("T")

STREAM_LIMIT = 65_536  # publishes that are kept for an `async for` that is too slow
CLOSED_HERE = "closed by this program"  # in the message of a request
ALIVE_CHECK_S = 0.2  # how soon an `async for` notices the end


class Listeners(Generic[T]):
    """The callbacks of one value or group."""

    def __init__(self, item: str) -> None:
        self._item = item
        self._lock = threading.Lock()  # held only to add or remove callbacks
        self._publish: tuple[Callable[[float, T], object], ...] = ()
        self._change: tuple[Callable[[T], object], ...] = ()
        self.previous: object = None  # nothing has been published yet
        self.heard = False
        """Whether publishes have a listener. Without one, a caller may set `previous` and skip `tell`."""

    def on_publish(self, callback: Callable[[float, T], object]) -> Callable[[], None]:
        self._check(callback)
        with self._lock:
            self._publish += (callback,)
            self.heard = True

        def remove() -> None:
            with self._lock:
                self._publish = tuple(c for c in self._publish if c is not callback)
                self.heard = bool(self._publish or self._change)

        return remove

    def on_change(self, callback: Callable[[T], object]) -> Callable[[], None]:
        self._check(callback)
        with self._lock:
            self._change += (callback,)
            self.heard = True

        def remove() -> None:
            with self._lock:
                self._change = tuple(c for c in self._change if c is not callback)
                self.heard = bool(self._publish or self._change)

        return remove

    def stream(
        self,
        begin: Callable[[], object],
        alive: Callable[[], bool],
        newest: Callable[[], tuple[float, T] | None] = lambda: None,
    ) -> AsyncIterator[tuple[float, T]]:
        """Iterate over (time_s, value) of every publish, from any thread, while `alive()` is true.

        `begin` starts the publishes. The listener is registered before, so the first publish is not lost. If
        publishes already come, the iteration begins with `newest`, because the next one may take long.
        """
        waiting: deque[tuple[float, T]] = deque(maxlen=STREAM_LIMIT)
        wake: list[Callable[[], object]] = []

        def take(time_s: float, value: T) -> None:
            if len(waiting) == STREAM_LIMIT:
                logger.warning("%s: a publish was lost, its reader is too slow", self._item)
            waiting.append((time_s, value))
            for call in wake:
                call()

        remove = self.on_publish(take)
        try:
            older = len(waiting)
            first = newest()
            if first is not None:  # publishes from before the request are in `first`, or are older
                for _ in range(older):
                    waiting.popleft()
            begin()
        except BaseException:
            remove()
            raise
        stream = self._stream(waiting, wake, first, alive, remove)
        finalize(stream, remove)  # the iteration may never start
        return stream

    @staticmethod
    async def _stream(
        waiting: deque[tuple[float, T]],
        wake: list[Callable[[], object]],
        first: tuple[float, T] | None,
        alive: Callable[[], bool],
        remove: Callable[[], None],
    ) -> AsyncIterator[tuple[float, T]]:
        loop = asyncio.get_running_loop()
        arrived = asyncio.Event()
        wake.append(partial(loop.call_soon_threadsafe, arrived.set))
        try:
            if first is not None:
                yield first
            while waiting or alive():
                while waiting:
                    one = waiting.popleft()
                    # Do not compare times: that of `first` may be by the PC's clock, and that of a publish is
                    # by the device's.
                    if first is None or one != first:  # otherwise it came during the request
                        yield one
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
            except Exception as error:
                self._report(publish, error)
        if self._change and value != self.previous:
            for change in self._change:
                try:
                    change(value)
                except Exception as error:
                    self._report(change, error)
        self.previous = value

    def _check(self, callback: object) -> None:
        if not callable(callback):
            raise ValueRangeError(f"{self._item}: {shown(callback)} is not a function")

    def _report(self, callback: object, error: Exception) -> None:
        if isinstance(error, LinkClosed) and CLOSED_HERE in error.message:
            return  # the end of a program, which came while the callback used the link
        logger.exception("%s: the callback %r raised; publishing goes on", self._item, callback)
