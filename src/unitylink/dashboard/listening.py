# SPDX-License-Identifier: BSD-3-Clause
"""The socket of the web server, and what limits a client that reads or writes too slowly."""

from __future__ import annotations

import asyncio
import socket
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from unitylink.errors import UnityLinkError

HEADERS_S = 4.0  # s from the first byte of a request to the end of its headers
UNREAD_MS = 4000  # ms after which a client that takes nothing is gone
BUFFER_BYTES = 64 * 1024  # what the kernel keeps for such a client


def listen(host: str, port: int) -> socket.socket:
    """Return a listening socket. Port 0 takes a free one. Raises UnityLinkError if that cannot be."""
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        opened = socket.socket(family, socket.SOCK_STREAM)
    except OSError as error:
        raise UnityLinkError(f"--listen {host}:{port}: {error.strerror or error}") from error
    try:
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        # both are inherited by each connection
        opened.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, BUFFER_BYTES)
        if hasattr(socket, "TCP_USER_TIMEOUT"):  # Linux
            opened.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNREAD_MS)
        opened.bind((host, port))
        opened.listen(128)
        opened.setblocking(False)
    except OSError as error:
        opened.close()
        raise UnityLinkError(f"--listen {host}:{port}: {error.strerror}; choose another port") from error
    return opened


class Protocol(H11Protocol):
    """HTTP with a deadline for the headers of each request. h11 itself limits their size to 64 KiB."""

    _deadline: asyncio.TimerHandle | None = None

    def connection_made(self, transport: Any) -> None:
        super().connection_made(transport)
        self._begin()

    def data_received(self, data: bytes) -> None:
        if self._deadline is None and self._between():
            self._begin()
        super().data_received(data)
        if not self._between():
            self._end()

    def connection_lost(self, exc: Exception | None) -> None:
        self._end()
        super().connection_lost(exc)

    def handle_websocket_upgrade(self, event: Any) -> None:
        self._end()
        super().handle_websocket_upgrade(event)

    def _between(self) -> bool:
        """Whether the headers of the next request are not complete yet."""
        return self.conn.their_state.__name__ == "IDLE"

    def _begin(self) -> None:
        self._deadline = self.loop.call_later(HEADERS_S, self.transport.abort)

    def _end(self) -> None:
        if self._deadline is not None:
            self._deadline.cancel()
            self._deadline = None
