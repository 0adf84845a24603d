# SPDX-License-Identifier: BSD-3-Clause
"""The link of a node: opens it when the device is there, and follows its loss and return in layer 2."""

from __future__ import annotations

import threading
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from unitylink.errors import LinkError, UnityLinkError

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

CHECK_S = 0.1  # how soon a loss is noticed


class Session(Protocol):
    """The work of a node on a link."""

    def forget(self) -> None:
        """Forget the commands that wait: the line is gone."""
        ...

    def stale(self) -> bool:
        """Whether the device may no longer hold what was written to it. Raises LinkError."""
        ...

    def renew(self) -> None:
        """Make the device fit for commands again, and safe before that. Raises LinkError."""
        ...

    def close(self) -> None: ...


class LinkKeeper:
    """Keep a session on a link: `connect()` opens one, `begin(link, again)` makes the session.

    Layer 2 opens a lost line again (`reconnect=1`). This class does the rest: the device may be absent at the
    beginning, and a device that comes back is made safe before commands are taken. A link that has ended for
    good (another device, a URL that cannot be opened again) is opened anew as at the beginning. `say(level,
    message)` hears of every change. An error that waiting cannot mend (a URL, a spec) ends the keeper:
    `failure`.
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
        except Exception as error:  # a defect, too, must end the node and not only this thread
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
                except LinkError as error:  # whether the line is gone is for layer 2 to say
                    if not self.up.is_set():
                        self._become(2, f"the link is lost: {error}")
        finally:
            session.close()

    def _rise(self, link: Link) -> None:
        self.up.set()  # before it is said, which may take a while: who hears it may send a command
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
