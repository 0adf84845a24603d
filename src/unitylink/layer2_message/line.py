# SPDX-License-Identifier: BSD-3-Clause
"""Line: the way to the device, which may be lost and come back."""

from __future__ import annotations

from collections.abc import AsyncIterator
from typing import TYPE_CHECKING

from unitylink.html_table import html_table

from .events import EventCallback, EventListener, LinkEvent, events_of

if TYPE_CHECKING:
    from unitylink._native import BoardServer, NativeLink

    from .callbacks import CallbackThread


class Line:
    """The part of a `Link` that is about its line. With `reconnect=1` a lost line is opened again."""

    url: str
    protocol: str
    _native: NativeLink
    _callbacks: CallbackThread
    _generations = 0  # of the sessions before a reset
    _server: BoardServer | None = None  # the dead-man of the board is also that of its clients

    def _repr_html_(self) -> str:
        """Return what a notebook shows: the state of the line, and counters. Nothing is sent."""
        state = "closed" if self._native.closed else self.trouble or "up"
        facts = {"state": state, "protocol": self.protocol, **self._native.statistics()}
        return html_table(f"link {self.url}", ("", ""), [(name, str(fact)) for name, fact in facts.items()])

    @property
    def up(self) -> bool:
        """Whether requests are accepted.

        No request is accepted while the line is gone (`reconnect=1`), nor after the end.
        """
        return not self._native.closed and not self._native.trouble

    @property
    def trouble(self) -> str:
        """Why the line is gone, and why the last try to open it failed. It is "" while the line is up."""
        return self._native.trouble

    def wait_up(self, timeout_s: float) -> bool:
        """Wait until requests are accepted. Return False if the line is still gone after `timeout_s`.

        Raises LinkClosed if the link has ended, or DeviceMismatch if another device answered.
        """
        return self._native.wait_up(timeout_s)

    @property
    def generation(self) -> int:
        """A number that changes whenever the device may have lost what was written to it.

        It changes after each restart of the device, and each time a lost line has come back.
        """
        return self._generations + self._native.generation

    def serve(self, plain: list[tuple[int, int]]) -> BoardServer:
        """Return a native server for many clients on this link. Close it before the link.

        `plain` are the first and last addresses of words whose read has no side effect, rising and apart.
        Only `unitylink.server` uses it. Raises DeviceMismatch if the link is not framed.
        """
        from unitylink._native import BoardServer

        self._server = BoardServer(self._native, plain)
        return self._server

    def watch_program(self, patience_s: float) -> None:
        """From now on, give up the line if `alive` is not called for `patience_s`. 0: never.

        The link gives signs of life to the dead-man as long as the process exists, even if the program hangs.
        After this call it does so only while the program works. If `alive` is not called, the line is given
        up as if it were lost. Nothing goes to the device, and a running dead-man trips. With `reconnect=1`,
        the line comes back when `alive` is called again. Otherwise the link ends. Raises ValueRangeError for
        more than 3600 s.

            link.watch_program(0.5)
            while running:
                control()
                link.alive()
        """
        self._native.watch_program(patience_s)

    def alive(self) -> None:
        """Tell the link that the program works. See `watch_program`. It costs well below a microsecond."""
        self._native.alive()

    def on_event(self, callback: EventCallback) -> None:
        """Call `callback(event)` for each event of the line and the device, in the link's callback thread.

            link.on_event(lambda event: print(event.kind, event.text))  # lost, restarted, back

        An exception in it is logged. It is called until the link is closed.
        """
        self._callbacks.add(EventListener(self._native, callback))

    def events(self) -> AsyncIterator[LinkEvent]:
        """Yield the events of the line and the device: `async for event in link.events()`."""
        return events_of(self._native)
