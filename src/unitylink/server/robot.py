# SPDX-License-Identifier: BSD-3-Clause
"""One board behind a server: its link, which is opened as often as necessary, and the native server on it."""

from __future__ import annotations

import threading
from typing import TYPE_CHECKING, Any

from unitylink.connection import connect
from unitylink.connection.schemes import scheme_of
from unitylink.errors import UnityLinkError
from unitylink.interface.wire_hash import wire_hashes
from unitylink.layer2_message import Link
from unitylink.spec.model import Spec

from .grants import grant
from .scopes import Rights

if TYPE_CHECKING:
    from unitylink._native import BoardServer, Knock

_PAUSE_S = 1.0  # between two attempts to open a link


class Robot:
    """A board with a name. A thread opens its link, and opens it again if it ends.

    `away` says why it cannot be used now, or is empty.
    """

    def __init__(self, name: str, url: str, spec: Spec) -> None:
        self.name, self.url, self.spec = name, url, spec
        self.away = f"{url} is being opened"
        self.opened = threading.Event()  # set after the first attempt
        self._link: Link | None = None
        self._server: BoardServer | None = None
        self._lock = threading.Lock()
        self._closed = threading.Event()
        self._thread = threading.Thread(target=self._keep_open, name=f"serve {name}", daemon=True)
        self._thread.start()

    def admit(self, knock: Knock, name: str, rights: Rights, text: str) -> bool:
        """Hand a client over to the board. Return False, and tell it why, if the board is away."""
        with self._lock:
            try:
                server = self._there()
            except UnityLinkError as error:
                knock.refuse("away", str(error))
                return False
            may = grant(self.spec, rights)
            server.admit(knock, name, may.reads, may.writes, may.arm, text)
            return True

    def stop_outputs(self) -> None:
        """Make the outputs safe now. Raises UnityLinkError if the board is away."""
        with self._lock:
            self._there().stop_outputs()

    def report(self) -> dict[str, Any]:
        """Return the state of the board, of its link and of its clients, as plain values."""
        with self._lock:
            told: dict[str, Any] = {"name": self.name, "link": self.url, "away": self._why_away()}
            if self._link is not None and self._server is not None:
                told["statistics"] = dict(vars(self._link.statistics()))
                told.update(self._server.report())
            return told

    def close(self) -> None:
        """Drop all clients and close the link."""
        self._closed.set()
        self._thread.join()
        with self._lock:
            self._let_go()

    def _why_away(self) -> str:
        """Return why clients cannot come in now. Hold the lock."""
        link = self._link
        if link is None or self._server is None:
            return self.away
        if link.closed:
            return "its link has ended"
        return "" if link.up else link.trouble or "its line is gone"

    def _there(self) -> BoardServer:
        """Return the native server, or raise UnityLinkError. Hold the lock."""
        why = self._why_away()
        if why or self._server is None:
            raise UnityLinkError(f"the board {self.name} is away: {why}")
        return self._server

    def _keep_open(self) -> None:
        while not self._closed.is_set():
            with self._lock:
                if self._link is None or self._link.closed:
                    self._let_go()
            if self._link is None:
                self._open()
                self.opened.set()
            self._closed.wait(_PAUSE_S)

    def _open(self) -> None:
        try:
            once = scheme_of(self.url).once or "reconnect=" in self.url
            link = connect(self.url, reconnect=None if once else True)
        except UnityLinkError as error:
            self.away = str(error)
            return
        try:
            link.check_spec(self.spec.source, wire_hashes(self.spec, self.spec.roots[0].name))
            server = link.serve()
        except UnityLinkError as error:
            self.away = str(error)
            link.close()
            return
        with self._lock:
            self._link, self._server, self.away = link, server, ""

    def _let_go(self) -> None:
        if self._server is not None:
            self._server.close()
        if self._link is not None:
            self._link.close()
        self._server = self._link = None
