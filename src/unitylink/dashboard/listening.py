# SPDX-License-Identifier: BSD-3-Clause
"""What limits a browser that sends its requests too slowly."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

HEADERS_S = 4.0  # s from the first byte of a request to the end of its headers


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
