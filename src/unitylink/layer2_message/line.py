# SPDX-License-Identifier: BSD-3-Clause
"""Line: what a program asks about the way to its device, which may be lost and come back."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import TYPE_CHECKING

from .events import EventCallback, EventListener, LinkEvent, events_of

if TYPE_CHECKING:
    from .callbacks import CallbackThread
    from .engine import Engine


class Line:
    """The part of a `Link` that is about its line; with `reconnect=1` a lost one is opened again."""

    _native: Engine
    _callbacks: CallbackThread

    @property
    def up(self) -> bool:
        """Whether requests are taken: not while the line is gone (`reconnect=1`), nor after the end."""
        return not self._native.closed and not self._native.trouble

    @property
    def trouble(self) -> str:
        """Why the line is gone, and why it could not be opened again the last time; "" while it is up."""
        return self._native.trouble

    def wait_up(self, timeout_s: float) -> bool:
        """Wait until requests are taken; False where the line is still gone after `timeout_s`.

        Raises LinkClosed when the link has ended, DeviceMismatch when another device answered.
        """
        return self._native.wait_up(timeout_s)

    @property
    def generation(self) -> int:
        """Another number each time the device may not hold any more what was written to it.

        So it is after each restart of the device, and each time a lost line has come back.
        """
        return self._native.generation

    def watch_program(self, patience_s: float) -> None:
        """From now on give the line up where `alive` is not called for `patience_s`; 0: never.

        The link gives the dead-man signs of life as long as the process exists, though the program hangs.
        With this it does so only while the program works: without it the line is given up as if it were lost,
        nothing goes to the device, and a dead-man that runs trips. With `reconnect=1` the line comes back
        when `alive` is called again; else the link ends. Raises ValueRangeError beyond 3600 s.

            link.watch_program(0.5)
            while running:
                control()
                link.alive()
        """
        self._native.watch_program(patience_s)

    def alive(self) -> None:
        """Say that the program works; see `watch_program`. It costs well below a microsecond."""
        self._native.alive()

    def on_event(self, callback: EventCallback) -> None:
        """Call `callback(event)` for what becomes of the line and the device, in the link's callback thread.

            link.on_event(lambda event: print(event.kind, event.text))  # lost, restarted, back

        What it raises is logged. It is called until the link is closed.
        """
        self._callbacks.add(EventListener(self._native, callback))

    def events(self) -> AsyncIterator[LinkEvent]:
        """Yield what becomes of the line and the device: `async for event in link.events()`."""
        return events_of(self._native)
