# SPDX-License-Identifier: BSD-3-Clause
"""Subscription: the publishes of one gateware group."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import AsyncIterator, Callable
from types import TracebackType
from typing import TYPE_CHECKING

from unitylink import _native
from unitylink.errors import LinkClosed
from unitylink.protocol import GROUPS_MAX

from .engine import Times, Words

if TYPE_CHECKING:
    from typing_extensions import Self

    from .link import Link

PublishCallback = Callable[[float, tuple[int, ...]], None]
ArraysCallback = Callable[[Times, Words], bool]

_log = logging.getLogger("unitylink.link")


class Subscription:
    """The publishes of one gateware group: raw words of `addresses`, with a time.

    On a framed link it is the time at which the device read them, by its clock in the host's time; on a
    classic one that of their arrival.
    """

    group: int
    addresses: tuple[int, ...]
    divisor: int

    def __init__(
        self,
        link: Link,
        identity: int,
        addresses: tuple[int, ...],
        divisor: int,
    ) -> None:
        """Made by Link.subscribe."""
        self.group = identity % GROUPS_MAX
        self.addresses = addresses
        self.divisor = divisor
        self._link = link  # a link lives as long as somebody has a subscription of it
        self._native = link._native
        self._identity = identity
        self._callbacks = link._callbacks
        self._open = True
        self._callback: PublishCallback | None = None
        self.gather_s = 0.0
        self._arrays: ArraysCallback | None = None

    @property
    def lost(self) -> int:
        """Publishes that were overwritten before anybody fetched them."""
        return self._native.lost(self._identity)

    @property
    def missing(self) -> int:
        """Publishes that were lost on the way; always 0 on a classic link, where nothing tells."""
        return self._native.missing(self._identity)

    @property
    def available(self) -> int:
        """Publishes that wait to be fetched."""
        return self._native.available(self._identity)

    def drain(self) -> tuple[Times, Words]:
        """Take all that has come, oldest first: (n,) times in s of time.monotonic, (n, k) words."""
        times, values = self._native.drain(self._identity, len(self.addresses))
        return times, values

    def wait(self, timeout_s: float) -> bool:
        """Wait until there is something to drain; False after `timeout_s`.

        Raises LinkClosed once nothing can come any more: link or subscription are closed, the port is gone.
        """
        return self._native.wait(self._identity, timeout_s)

    def on_publish(
        self,
        callback: PublishCallback,
        *,
        gather_s: float = 0.0,
        arrays: ArraysCallback | None = None,
    ) -> None:
        """Call `callback(time_s, words)` for every publish from now on, in the link's callback thread.

        With `gather_s` the thread may rest so long between two looks, so that a fast stream does not wake it
        for each publish; it does while all callbacks of the link allow it, and then for the shortest.
        With `arrays` several that have come together are offered first, as from `drain`: where
        `arrays(times, words)` is True, it has taken all of it.
        What a callback raises is logged; the thread goes on. A subscription has one callback, the last given.
        A port that is gone ends the calls; that is logged too.
        """
        if not self._open:
            raise LinkClosed("the subscription is closed")
        self._callback, self._arrays = callback, arrays
        self.gather_s = gather_s
        self._callbacks.add(self)

    async def __aiter__(self) -> AsyncIterator[tuple[float, tuple[int, ...]]]:
        """Yield (time_s, words) of every publish until link or subscription are closed.

        Raises LinkClosed when the port is gone.
        """
        loop = asyncio.get_running_loop()
        arrived = asyncio.Event()
        mailbox = _native.mailbox()

        def wake() -> None:
            mailbox.collect()
            arrived.set()

        loop.add_reader(mailbox.descriptor, wake)
        self._native.notify_publishes(mailbox.descriptor)
        try:
            while True:
                times, values = self.drain()
                for time_s, words in zip(times.tolist(), values.tolist(), strict=True):
                    yield time_s, tuple(words)
                if len(times):
                    continue
                if not self._open:
                    return
                if self._native.closed:
                    self._native.check_alive()
                    return
                await arrived.wait()
                arrived.clear()
        finally:
            self._native.forget_notification(mailbox.descriptor)
            loop.remove_reader(mailbox.descriptor)

    def close(self) -> None:
        """Stop the group's publishes and free the group; what came before can still be drained."""
        if self._open:
            self._open = False
            self._callback = self._arrays = None
            self._callbacks.remove(self)
            if not self._native.closed:
                self._native.unsubscribe(self._identity)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<Subscription of {len(self.addresses)} words, group {self.group}, divisor {self.divisor}>"

    def deliver(self) -> None:
        """Fetch what has come and call back for each; what the callback raises does not stop the rest."""
        callback = self._callback
        if callback is None:
            return
        arrays = self._arrays
        times, values = self.drain()
        if arrays is not None and len(times) > 1:  # one alone is sooner told as it is
            try:
                if arrays(times, values):
                    return
            except BaseException:
                _log.exception("arrays callback of %r failed; the publishes go on", self)
                return
        rows = zip(times.tolist(), map(tuple, values.tolist()), strict=True)
        while True:
            try:
                for time_s, words in rows:
                    if self._callback is not callback:  # it closed the subscription, or gave another
                        return
                    callback(time_s, words)
                return
            except BaseException:  # sys.exit() too: it would silence the other subscriptions
                _log.exception("callback of %r failed; the publishes go on", self)
