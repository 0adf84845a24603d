# SPDX-License-Identifier: BSD-3-Clause
"""Subscription: the publishes of one gateware group."""

from __future__ import annotations

import logging
import threading
from collections.abc import AsyncIterator, Callable, Iterator
from types import TracebackType
from typing import TYPE_CHECKING

import numpy as np

from unitylink.errors import LinkClosed
from unitylink.protocol import GROUPS_MAX

from .callbacks import CallbackThread, called_back
from .mailbox import arrivals
from .native_link import Times, Words

if TYPE_CHECKING:
    from typing_extensions import Self

    from unitylink._native import NativeLink

Publish = tuple[float, tuple[int, ...]]
PublishCallback = Callable[[float, tuple[int, ...]], None]
ArraysCallback = Callable[[Times, Words], bool]
Taker = Callable[["NativeLink", int], object]

_log = logging.getLogger("unitylink.link")


class Subscription:
    """The publishes of one gateware group: raw words of `addresses`, with a time.

    On a framed link, this is the time at which the device read them, by its clock, converted to the host's
    time. On a classic link it is the time of their arrival.
    """

    group: int
    addresses: tuple[int, ...]
    divisor: int

    def __init__(
        self,
        native: NativeLink,
        callbacks: CallbackThread,
        identity: int,
        addresses: tuple[int, ...],
        divisor: int,
        *,
        release: Callable[[int], None],
        keep: object = None,
    ) -> None:
        """Made by Link.subscribe. `keep`, the link, lives as long as this. `release(identity)` ends it."""
        self.group = identity % GROUPS_MAX
        self.addresses = addresses
        self._words = len(addresses)
        self.divisor = divisor
        self._keep = keep
        self._release = release
        self._native = native
        self._identity = identity
        self._callbacks = callbacks
        self._open = True
        self._ending = threading.Lock()  # held while closing
        self._taking = threading.Lock()  # held while fetching, calling back and draining
        self._rows: Iterator[Publish] = iter(())
        self._kept: list[Publish] = []
        self._lost: tuple[int, int] | None = None
        self._callback: PublishCallback | None = None
        self.gather_s = 0.0
        self.told = 0  # number of calls begun
        self._arrays: ArraysCallback | None = None
        self._taker: Taker | None = None
        self._first: Publish | None = None

    @property
    def lost(self) -> int:
        """Publishes that were overwritten before they were fetched."""
        return self._native.lost(self._identity) if self._lost is None else self._lost[0]

    @property
    def missing(self) -> int:
        """Publishes that were lost on the way. Always 0 on a classic link, which cannot tell."""
        return self._native.missing(self._identity) if self._lost is None else self._lost[1]

    @property
    def available(self) -> int:
        """Publishes that wait to be fetched."""
        with self._taking:
            return len(self._kept) + self._native.available(self._identity)

    def drain(self) -> tuple[Times, Words]:
        """Take everything that has come, oldest first: (n,) times in s of time.monotonic, (n, k) words."""
        with self._taking:
            kept, self._kept = self._kept, []
            times, values = self._native.drain(self._identity, self._words)
        if kept:
            times = np.concatenate([[time_s for time_s, _ in kept], times])
            values = np.concatenate([np.array([words for _, words in kept], dtype=np.uint32), values])
        return times, values

    def wait(self, timeout_s: float) -> bool:
        """Wait until there is something to drain. The result is False after `timeout_s`.

        Raises LinkClosed if nothing more can come: the link or the subscription is closed, or the port is
        gone.
        """
        try:
            return bool(self._kept) or self._native.wait(self._identity, timeout_s)
        except LinkClosed:
            with self._taking:
                if self._kept:
                    return True
            raise

    def on_publish(
        self,
        callback: PublishCallback,
        *,
        gather_s: float = 0.0,
        arrays: ArraysCallback | None = None,
        first: Publish | None = None,
    ) -> None:
        """Call `callback(time_s, words)` for every publish from now on, in the link's callback thread.

        With `gather_s` the thread may sleep so long between two looks. So a fast stream does not wake it for
        each publish. It sleeps only if all callbacks of the link allow it, and then for the shortest time.
        With `arrays`, several publishes that have come together are offered to it first, in the form of
        `drain`. If `arrays(times, words)` returns True, it has taken all of them. `first` is called before
        all publishes, as if it were one.

        An exception in a callback is logged, and the thread goes on. A subscription has one callback, the
        last one given. If the port is gone, the calls end, and this is logged.
        """
        if not self._open:
            raise LinkClosed("the subscription is closed")
        self._callback, self._arrays, self._first, self._taker = callback, arrays, first, None
        self.gather_s = gather_s
        self._callbacks.add(self)

    def hand_over(self, take: Taker, *, gather_s: float = 0.0) -> None:
        """Let `take(native, identity)` drain the publishes itself, in the link's callback thread.

        It is called when some may have come. This is for a program that needs none of them in Python. All
        else is as with `on_publish`, whose place it takes.
        """
        if not self._open:
            raise LinkClosed("the subscription is closed")
        self._callback = self._arrays = self._first = None
        self._taker, self.gather_s = take, gather_s
        self._callbacks.add(self)

    async def __aiter__(self) -> AsyncIterator[tuple[float, tuple[int, ...]]]:
        """Yield (time_s, words) of every publish until link or subscription are closed.

        Raises LinkClosed if the port is gone, and DeviceMismatch if another board has come that refuses it.
        """
        with arrivals(self._native) as arrived:
            while True:
                over = self._native.closed or not self._native.subscribed(self._identity)
                times, values = self.drain()
                for time_s, words in zip(times.tolist(), values.tolist(), strict=True):
                    yield time_s, tuple(words)
                if len(times):
                    continue
                if over:
                    if self._open:
                        self._native.check_alive()
                        if not self._native.closed:
                            self._native.wait(self._identity, 0.0)  # it has ended by itself
                    return
                await arrived.wait()
                arrived.clear()

    def close(self) -> None:
        """Stop the group's publishes and free the group. Calling it twice does no harm.

        No publish that has come is lost. When this returns, the callback has had all of them and is not
        called again. Without a callback they can still be drained, whatever happens to the group.

        Within a callback of any subscription, this waits for nothing. The remaining publishes can then be
        drained. Anywhere else it waits for a running call. So hold no lock that the callback needs. A call
        that does not return within five seconds is not waited for. It gives a RuntimeWarning.
        """
        within = called_back()
        if within:
            self.hush()
        if not self._ending.acquire(blocking=not within):  # another close() waits for this callback
            return
        try:
            if self._open:
                self._open, self.gather_s = False, 0.0
                self._end(within)
        finally:
            self._ending.release()

    def _end(self, within: bool) -> None:
        native = self._native
        try:
            if not native.closed:
                self._release(self._identity)
        finally:
            try:
                if not within and (self.ended or native.closed):
                    self._callbacks.finish(self)
            finally:
                self._callbacks.remove(self)
                self.hush()
                self._lost = native.lost(self._identity), native.missing(self._identity)
                with self._taking:  # the next subscription of the group takes its place
                    times, values = native.drain(self._identity, self._words)
                    self._kept += _rows_of(times, values)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Subscription of {len(self.addresses)} words, group {self.group}, divisor {self.divisor}>"

    @property
    def ended(self) -> bool:
        """Whether it was closed, so that nothing comes any more."""
        return not self._open and not self._native.subscribed(self._identity)

    def hush(self) -> None:
        """Call the callback no more. The publishes that have come can then be drained."""
        self._callback = self._arrays = self._taker = None
        with self._taking:
            self._kept += self._rows

    def deliver(self) -> None:
        """Fetch the publishes and call back for each. An exception in one call does not stop the rest."""
        if (taker := self._taker) is not None:
            self.told += 1
            try:
                taker(self._native, self._identity)
            except BaseException:
                self._report(taker)
            return
        callback, first = self._callback, self._first
        if callback is not None and first is not None:
            self._first = None
            self._tell(callback, first)
            callback = self._callback
        if callback is None:
            return
        single = self._native.take_single(self._identity, self._words)
        if single is None:
            self._deliver_all(callback)
        else:
            self._tell(callback, single)

    def _tell(self, callback: PublishCallback, publish: Publish) -> None:
        self.told += 1
        try:
            callback(*publish)
        except BaseException:  # sys.exit() too, which would otherwise end the other subscriptions
            self._report(callback)

    def _deliver_all(self, callback: PublishCallback | None) -> None:
        times, values = self._native.drain(self._identity, self._words)
        self.told += 1
        if self._arrays is not None and len(times) > 1:  # a single one is faster without arrays
            try:
                if self._arrays(times, values):
                    return
            except BaseException:
                self._report(self._arrays)
                return
        self._rows = _rows_of(times, values)
        while callback is not None:
            try:
                for time_s, words in self._rows:
                    self.told += 1
                    callback(time_s, words)
                    # the callback closed the subscription, or set another callback
                    if self._callback is not callback:
                        break
                else:
                    return
            except BaseException:
                self._report(callback)
            callback = self._callback

    def _report(self, callback: object) -> None:
        _log.exception("the callback %r of %r failed; the publishes go on", callback, self)


def _rows_of(times: Times, values: Words) -> Iterator[Publish]:
    return zip(times.tolist(), map(tuple, values.tolist()), strict=True)
