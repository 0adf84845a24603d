# SPDX-License-Identifier: BSD-3-Clause
"""What happens to a line, and to the device behind it, while a program runs."""

from __future__ import annotations

import logging
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Literal

from .mailbox import arrivals

if TYPE_CHECKING:
    from unitylink._native import NativeLink

_log = logging.getLogger("unitylink.link")


@dataclass(frozen=True)
class LinkEvent:
    """An event of a link: `lost`, then `restarted` if the device was restarted, then `back`.

    `restarted` comes alone if the device was reset and its line stayed.
    """

    kind: Literal["lost", "restarted", "back"]
    """`lost`: the line is gone or the device silent, and is being opened again. `restarted`: the device was
    reset, or another program has had it, so its outputs are its own. `back`: requests are taken again, and
    subscriptions go on."""
    time_s: float
    """When, by `Link.now_s()`."""
    text: str
    """Why, in words."""


EventCallback = Callable[[LinkEvent], None]


class EventListener:
    """Calls `callback` for each event from now on, in the link's callback thread."""

    ended = False

    def __init__(self, native: NativeLink, callback: EventCallback) -> None:
        self._native, self._callback = native, callback
        self._next = native.events(0)[1]
        self.gather_s = inf  # no limit of its own, because events are rare
        self.told = 0

    def deliver(self) -> None:
        rows, self._next = self._native.events(self._next)
        for row in rows:
            if self.ended:
                return
            self.told += 1
            try:
                self._callback(LinkEvent(*row))
            except BaseException:  # sys.exit() too, which would otherwise end the subscriptions
                _log.exception("the callback %r of an event failed; the events go on", self._callback)

    def hush(self) -> None:
        """Call the callback no more."""
        self.ended = True


async def events_of(native: NativeLink) -> AsyncIterator[LinkEvent]:
    """Yield each event from now on, until the link is closed."""
    _, since = native.events(0)
    with arrivals(native) as arrived:
        while True:
            over = native.closed
            rows, since = native.events(since)
            for row in rows:
                yield LinkEvent(*row)
            if over:
                return
            await arrived.wait()
            arrived.clear()
