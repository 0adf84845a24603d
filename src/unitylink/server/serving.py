# SPDX-License-Identifier: BSD-3-Clause
"""A server: the door, the robots behind it, and who may come in."""

from __future__ import annotations

import resource
import threading
import time
from collections.abc import Iterable
from typing import Any

from unitylink import _native
from unitylink.errors import AccessRefused, UnityLinkError
from unitylink.protocol import SERVE_VERSION

from .audit import Audit
from .gate import REFUSED_BURST, REFUSED_RATE_HZ
from .questions import answer_question
from .rate_limit import RateLimit
from .robot import Robot
from .tls_files import TlsFiles
from .tokens import Tokens, User

_LOOK_S = 0.2  # how often the door looks whether the server ends
CLIENTS_MAX = 1024  # of all robots together
CLIENTS_KEPT = 16  # of these, for users who have no connection yet
FILES_MOST = 4096  # open files of the process: a connection is one, and Linux gives a program 1,024 at first
TALKS_MAX = 8  # questions that are being answered at the same time


def allow_files() -> None:
    """Let this process have open files for all clients, as far as the system permits."""
    most, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    wanted = FILES_MOST if hard == resource.RLIM_INFINITY else min(FILES_MOST, hard)
    if most != resource.RLIM_INFINITY and most < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))


class Server:
    """Serves robots at HOST:PORT until `close`. `place` is where it listens.

    With `tls`, all connections are encrypted. The programs that are part of the server, such as its page,
    show one of the `own` tokens. They come in at `own_place`, which is on this machine and not encrypted.

        robot = Robot("arm", "serial:/dev/ttyUSB0", spec, tokens, audit)
        with Server([robot], tokens, audit, "127.0.0.1", 7450) as server:
            print(server.place)

    Raises LinkNotFound if there is no such address here, and LinkBusy if another program has the port.
    """

    def __init__(
        self,
        robots: Iterable[Robot],
        tokens: Tokens,
        audit: Audit,
        host: str,
        port: int,
        *,
        tls: TlsFiles | None = None,
        own: Tokens | None = None,
    ) -> None:
        self.robots = {robot.name: robot for robot in robots}
        self.refused = 0
        self._audit = audit
        self._lines = RateLimit(REFUSED_RATE_HZ, REFUSED_BURST)  # a flood of refusals must not fill the disk
        files = (tls.certificate, tls.key, tls.authorities) if tls else ()
        self._doors = [(_native.Door(host, port, *files), tokens)]
        if tls and own:
            self._doors.append((_native.Door("127.0.0.1", 0), own))
        self.place: str = self._doors[0][0].place
        self.own_place: str = self._doors[-1][0].place
        self._closed = threading.Event()
        self._talks = threading.BoundedSemaphore(TALKS_MAX)
        self._threads = [
            threading.Thread(target=self._answer, args=each, name="serve door", daemon=True)
            for each in self._doors
        ]
        for robot in self.robots.values():
            robot.start()
        for thread in self._threads:
            thread.start()

    def __enter__(self) -> Server:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def report(self) -> dict[str, Any]:
        """Return the state of all robots, and how many callers were refused, as plain values."""
        return {**self._told(), "robots": [robot.report() for robot in self.robots.values()]}

    def _told(self) -> dict[str, Any]:
        turned_away = sum(door.turned_away for door, _ in self._doors)
        return {
            "refused": self.refused,
            "turned_away": turned_away,
            "log_lines_lost": self._audit.unwritten,
        }

    def close(self) -> None:
        """Let nobody in any more, drop all clients and close the links."""
        self._closed.set()
        for thread in self._threads:
            thread.join()
        for robot in self.robots.values():
            robot.close()

    def _answer(self, door: _native.Door, tokens: Tokens) -> None:
        while not self._closed.is_set():
            knock = door.wait(_LOOK_S)
            if knock is not None:
                self._let_in(knock, tokens)

    def _let_in(self, knock: _native.Knock, tokens: Tokens) -> None:
        """Admit or refuse one caller."""
        if knock.version != SERVE_VERSION:
            text = f"this server speaks version {SERVE_VERSION} of the login, not {knock.version}"
            return self._refuse(knock, "version", f"{text}; update the older side")
        user = tokens.user(knock.token, time.time())
        if user is None:
            why = "wrong, or has expired" if knock.token else "missing"
            return self._refuse(
                knock,
                "token",
                f"the token is {why}; put it into UNITYLINK_TOKEN, or name its file: ?token_file=",
            )
        robot = self._robot(knock.board)
        if knock.asks and (robot is not None or not knock.board):
            robots = [robot] if robot is not None else list(self.robots.values())
            return self._begin_answer(knock, user, robots)
        if robot is None:
            text = f"there is no board {knock.board!r}" if knock.board else "the URL names no board"
            return self._refuse(knock, "board", f"{text}; there are: {', '.join(self.robots)}", user)
        left = CLIENTS_MAX - sum(one.connected for one in self.robots.values())
        if left <= 0:
            return self._refuse(knock, "full", f"{CLIENTS_MAX} clients are connected, which is all", user)
        if left <= CLIENTS_KEPT and any(one.has(user.name) for one in self.robots.values()):
            text = f"the last {left} places are for users who have no connection, and {user.name} has some"
            return self._refuse(knock, "full", text, user)
        try:
            robot.admit(knock)
        except AccessRefused as error:  # the token has expired just now
            self._refuse(knock, "token", str(error), user)
        except UnityLinkError as error:
            self._refuse(knock, "away", str(error), user)
        return None

    def _begin_answer(self, knock: _native.Knock, user: User, robots: list[Robot]) -> None:
        """Answer a question, in a thread of its own, because the client may be slow."""
        if not self._talks.acquire(blocking=False):
            return self._refuse(knock, "full", f"{TALKS_MAX} clients are asking already", user)
        talk, where = knock.converse(f"{user.name} may {user.rights}"), knock.peer

        def answer() -> None:
            try:
                answer_question(talk, user, where, robots, self._told)
            finally:
                self._talks.release()

        threading.Thread(target=answer, name="serve question", daemon=True).start()
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
