# SPDX-License-Identifier: BSD-3-Clause
"""A server: the door, the robots behind it, and who may come in."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterable
from typing import Any

from unitylink import _native
from unitylink.errors import AccessRefused, UnityLinkError
from unitylink.protocol import SERVE_VERSION

from .audit import Audit
from .gate import REFUSED_BURST, REFUSED_RATE_HZ
from .rate_limit import RateLimit
from .robot import Robot
from .tokens import Tokens, User

_LOOK_S = 0.2  # how often the door looks whether the server ends
CLIENTS_MAX = 1024  # of all robots together


class Server:
    """Serves robots at HOST:PORT until `close`. `place` is where it listens.

        robot = Robot("arm", "serial:/dev/ttyUSB0", spec, tokens, audit)
        with Server([robot], tokens, audit, "127.0.0.1", 7450) as server:
            print(server.place)

    Raises LinkNotFound if there is no such address here, and LinkBusy if another program has the port.
    """

    def __init__(self, robots: Iterable[Robot], tokens: Tokens, audit: Audit, host: str, port: int) -> None:
        self.robots = {robot.name: robot for robot in robots}
        self.refused = 0
        self._tokens, self._audit = tokens, audit
        self._lines = RateLimit(REFUSED_RATE_HZ, REFUSED_BURST)  # a flood of refusals must not fill the disk
        self._door = _native.Door(host, port)
        self.place: str = self._door.place
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._answer, name="serve door", daemon=True)
        self._thread.start()

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def report(self) -> dict[str, Any]:
        """Return the state of all robots, and how many callers were refused, as plain values."""
        robots = [robot.report() for robot in self.robots.values()]
        return {"robots": robots, "refused": self.refused, "turned_away": self._door.turned_away}

    def close(self) -> None:
        """Let nobody in any more, drop all clients and close the links."""
        self._closed.set()
        self._thread.join()
        for robot in self.robots.values():
            robot.close()

    def _answer(self) -> None:
        while not self._closed.is_set():
            knock = self._door.wait(_LOOK_S)
            if knock is not None:
                self._let_in(knock)

    def _let_in(self, knock: _native.Knock) -> None:
        """Admit or refuse one caller."""
        if knock.version != SERVE_VERSION:
            text = f"this server speaks version {SERVE_VERSION} of the login, not {knock.version}"
            return self._refuse(knock, "version", f"{text}; update the older side")
        user = self._tokens.user(knock.token, time.time())
        if user is None:
            why = "wrong, or has expired" if knock.token else "missing"
            return self._refuse(
                knock,
                "token",
                f"the token is {why}; put it into UNITYLINK_TOKEN, or name its file: ?token_file=",
            )
        robot = self._robot(knock.board)
        if robot is None:
            text = f"there is no board {knock.board!r}" if knock.board else "the URL names no board"
            return self._refuse(knock, "board", f"{text}; there are: {', '.join(self.robots)}", user)
        if sum(one.connected for one in self.robots.values()) >= CLIENTS_MAX:
            return self._refuse(knock, "full", f"{CLIENTS_MAX} clients are connected, which is all", user)
        try:
            robot.admit(knock)
        except AccessRefused as error:  # the token has expired just now
            self._refuse(knock, "token", str(error), user)
        except UnityLinkError as error:
            self._refuse(knock, "away", str(error), user)
        return None

    def _robot(self, name: str) -> Robot | None:
        if not name and len(self.robots) == 1:
            return next(iter(self.robots.values()))
        return self.robots.get(name)

    def _refuse(self, knock: _native.Knock, reason: str, text: str, user: User | None = None) -> None:
        self.refused += 1
        name = user.name if user else None
        if self._lines.allow(time.monotonic()):
            self._audit.line("refused", time.time(), user=name, where=knock.peer, reason=reason)
        knock.refuse(reason, text)
