# SPDX-License-Identifier: BSD-3-Clause
"""The link of a node.

It opens the link when the device is there. Layer 2 handles a loss and a return, and the keeper follows them.
"""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from unitylink.errors import LinkError, UnityLinkError

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

CHECK_S = 0.1  # how soon a loss is noticed


class Session(Protocol):
    """What a node does on a link."""

    def forget(self) -> None:
        """Forget the waiting commands, because the line is gone."""
        ...

    def stale(self) -> bool:
        """Whether the device may have lost what was written to it. Raises LinkError."""
        ...

    def renew(self) -> None:
        """Make the device safe, and then ready for commands again. Raises LinkError."""
        ...

    def close(self) -> None: ...


class LinkKeeper:
    """Keep a session on a link. `connect()` opens a link, and `begin(link, again)` makes the session.

    Layer 2 opens a lost line again (`reconnect=1`). This class does the rest. The device may be absent at the
    beginning. A device that comes back is made safe before commands are taken. A link may end for good
    (another device, a URL that cannot be opened again). Then it is opened again as at the beginning.
    `say(level, message)` gets every change. Waiting cannot mend some errors, such as those of a URL or a
    spec. Such an error ends the keeper and is its `failure`.
    """

    def __init__(
        self,
        connect: Callable[[], Link],
        begin: Callable[[Link, bool], Session],
        say: Callable[[int, str], None],
        *,
        retry_s: float = 1.0,
    ) -> None:
        self.state = "waiting for the device"
        self.up = threading.Event()
        self.ended = threading.Event()
        self.failure: Exception | None = None
        self.losses = 0
        self._connect, self._begin, self._say, self._retry_s = connect, begin, say, retry_s
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="unitylink-ros-link", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End the session and the link."""
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        again = False
        try:
            while not self._stop.is_set():
                try:
                    link = self._connect()
                    try:
                        self._keep(link, self._begin(link, again))
                        again = True
                    finally:
                        self.up.clear()
                        link.close()
                    self._stop.wait(self._retry_s)
                except LinkError as error:
                    self._become(1, f"waiting for the device: {error}")
                    self._stop.wait(self._retry_s)
        except Exception as error:  # a defect, too, must end the whole node and not only this thread
            self.failure = error
            self.state = str(error) if isinstance(error, UnityLinkError) else f"internal error: {error!r}"
            self._say(2, self.state)
        finally:
            self.up.clear()
            self.ended.set()

    def _become(self, level: int, state: str) -> None:
        if state != self.state:
            self.state = state
            self._say(level, state)

    def _keep(self, link: Link, session: Session) -> None:
        """Return when the link has ended."""
        self._rise(link)
        try:
            while not self._stop.wait(CHECK_S):
                if link.closed:
                    self._fall(session, _why_closed(link))
                    return
                if not link.up:
                    self._fall(session, link.trouble)
                    continue
                try:
                    if self.up.is_set() and session.stale():
                        self._fall(session, "the device has lost the values that were written to it")
                    if not self.up.is_set():
                        session.renew()
                        self._rise(link)
                except LinkError as error:  # layer 2 decides whether the line is gone
                    if not self.up.is_set():
                        self._become(2, f"the link is lost: {error}")
        finally:
            session.close()

    def _rise(self, link: Link) -> None:
        # set before the message, which may take a while, because its receiver may send a command
        self.up.set()
        self._become(0, f"connected to {link.url}")

    def _fall(self, session: Session, reason: str) -> None:
        if self.up.is_set():
            self.losses += 1
            self.up.clear()
            session.forget()
            self._become(2, f"the link is lost: {reason}")


def _why_closed(link: Link) -> str:
    try:
        link.check_alive()
    except LinkError as error:
        return str(error)
    return "it was closed"
