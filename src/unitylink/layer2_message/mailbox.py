# SPDX-License-Identifier: BSD-3-Clause
"""How an event loop learns which of its requests are done."""

from __future__ import annotations

import asyncio
import itertools
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from unitylink import _native


class LoopMailbox:
    """A mailbox for one event loop and one link. The loop watches its descriptor."""

    def __init__(self, native: _native.NativeLink, loop: asyncio.AbstractEventLoop) -> None:
        self._native = native
        self._loop = loop
        self._mailbox = _native.mailbox()
        self._tickets = itertools.count(1)
        self._waiting: dict[int, tuple[_native.Pending, asyncio.Future[Any]]] = {}
        self._retired = False
        loop.add_reader(self._mailbox.descriptor, self._collect)

    def start(self, *request: Any) -> asyncio.Future[Any]:
        ticket = next(self._tickets)
        future: asyncio.Future[Any] = self._loop.create_future()
        pending = self._native.start(self._mailbox, ticket, *request)
        future.add_done_callback(lambda done: pending.withdraw(self._native) if done.cancelled() else None)
        self._waiting[ticket] = (pending, future)  # the loop cannot look before this coroutine yields
        return future

    def retire(self) -> None:
        """Stop watching if no request waits. Called in the loop's thread when the link is closed."""
        self._retired = True
        if not self._waiting:
            self._loop.remove_reader(self._mailbox.descriptor)

    def _collect(self) -> None:
        for ticket in self._mailbox.collect():
            pending, future = self._waiting.pop(ticket)
            if future.cancelled():
                continue
            try:
                future.set_result(pending.result(self._native))
            except Exception as error:
                future.set_exception(error)
        if self._retired:
            self.retire()


@contextmanager
def arrivals(native: _native.NativeLink) -> Iterator[asyncio.Event]:
    """Yield an asyncio.Event that is set when a link has news."""
    loop = asyncio.get_running_loop()
    arrived = asyncio.Event()
    mailbox = _native.mailbox()

    def wake() -> None:
        mailbox.collect()
        arrived.set()

    loop.add_reader(mailbox.descriptor, wake)
    native.notify_publishes(mailbox.descriptor)
    try:
        yield arrived
    finally:
        native.forget_notification(mailbox.descriptor)
        loop.remove_reader(mailbox.descriptor)
