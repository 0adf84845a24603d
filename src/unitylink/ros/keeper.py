# SPDX-License-Identifier: BSD-3-Clause
"""A link that comes back: opened when the device is there, watched, closed when it is lost, opened again."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

from unitylink.errors import LinkError, UnityLinkError

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

CHECK_S = 0.1  # how soon a port that is gone is noticed
SILENCE_S = 0.5  # without a publish for so long the device is asked whether it is there


class Session(Protocol):
    """What lives as long as one link."""

    def quiet_s(self) -> float:
        """Return for how long nothing has come."""
        ...

    def check(self) -> None:
        """Raise LinkError where the device is there but no longer as it was."""
        ...

    def probe(self) -> None:
        """Ask the device for something harmless; raise LinkError where it does not answer."""
        ...

    def close(self) -> None: ...


class LinkKeeper:
    """Keep a session on a link: `connect()` opens one, `begin(link, again)` makes the session.

    `say(level, message)` hears of every change. What no waiting can mend (a URL, a spec) ends the keeper:
    `failure` has it.
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
        self.failure: UnityLinkError | None = None
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
        said = ""
        try:
            while not self._stop.is_set():
                try:
                    link = self._connect()
                except LinkError as error:
                    said = self._waiting(error, said)
                    continue
                try:
                    session = self._begin(link, again)
                except LinkError as error:
                    link.close()
                    said = self._waiting(error, said)
                    continue
                except BaseException:
                    link.close()
                    raise
                again, said = True, ""
                self._watch(link, session)
        except UnityLinkError as error:
            self.failure = error
            self.state = str(error)
            self._say(2, str(error))
        finally:
            self.up.clear()
            self.ended.set()

    def _waiting(self, error: LinkError, said: str) -> str:
        self.state = f"waiting for the device: {error}"
        if self.state != said:
            self._say(1, self.state)
        self._stop.wait(self._retry_s)
        return self.state

    def _watch(self, link: Link, session: Session) -> None:
        self.state = f"connected to {link.url}"
        self._say(0, self.state)
        self.up.set()
        asked_s = time.monotonic()
        try:
            while not self._stop.wait(CHECK_S):
                if link.closed:
                    raise LinkError(f"{link.url}: the port is gone")
                session.check()
                if session.quiet_s() > SILENCE_S and time.monotonic() - asked_s > SILENCE_S:
                    asked_s = time.monotonic()
                    session.probe()
        except LinkError as error:
            self.losses += 1
            self.state = f"the link is lost: {error}"
            self.up.clear()
            self._say(2, self.state)
        finally:
            self.up.clear()
            session.close()
            link.close()
