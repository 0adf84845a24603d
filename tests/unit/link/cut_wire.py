# SPDX-License-Identifier: BSD-3-Clause
"""A TCP line between a link and a board. It can be cut after any byte, stopped, or led to another board."""

from __future__ import annotations

import contextlib
import select
import socket
import threading
from collections.abc import Callable
from urllib.parse import urlsplit

TO_BOARD, TO_HOST = "to the board", "to the host"


class CutWire:
    """Forwards bytes. `cut_after(way, count)` breaks the line after `count` more bytes in one direction.

    `on_cut` is called then, before the next client can connect. So a test may replace the board meanwhile.
    """

    def __init__(self, board_url: str) -> None:
        self.board_url = board_url
        self.cuts = 0
        self.stopped = False  # if true, bytes are taken and dropped
        self.on_cut: Callable[[], None] = lambda: None
        self._left: dict[str, int | None] = {TO_BOARD: None, TO_HOST: None}
        self._change: Callable[[], str] | None = None
        self._over = threading.Event()
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._listener.getsockname()[1]}"
        self._wake, self._woken = socket.socketpair()
        self._thread = threading.Thread(target=self._serve, name="cut wire", daemon=True)
        self._thread.start()

    def cut_after(self, way: str, count: int) -> None:
        self._left[way] = count
        self._wake.send(b".")

    def lead_to(self, change: Callable[[], str]) -> None:
        """Lead the line to the board that `change` makes. The client notices nothing."""
        self._change = change
        self._wake.send(b".")

    def close(self) -> None:
        self._over.set()
        self._wake.send(b".")
        self._thread.join()
        for one in (self._listener, self._wake, self._woken):
            one.close()

    def _serve(self) -> None:
        while not self._over.is_set():
            ready, _, _ = select.select([self._listener, self._woken], [], [])
            if self._woken in ready:
                self._woken.recv(64)
                continue
            host, _ = self._listener.accept()
            host.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            board = self._to_board()
            try:
                board = self._forward(host, board)
            finally:
                board.close()  # closed first, so that the board is free again when the host comes back
                host.close()
                if self._left != {TO_BOARD: None, TO_HOST: None}:
                    self._left = {TO_BOARD: None, TO_HOST: None}
                    self.cuts += 1
                    self.on_cut()

    def _to_board(self) -> socket.socket:
        place = urlsplit(self.board_url)
        return socket.create_connection((place.hostname, place.port))

    def _forward(self, host: socket.socket, board: socket.socket) -> socket.socket:
        """Return the socket to the board that is there at the end."""
        while not self._over.is_set() and 0 not in self._left.values():
            ready, _, _ = select.select([host, board, self._woken], [], [])
            if self._woken in ready:
                self._woken.recv(64)
                if self._change is not None:
                    board.close()
                    self.board_url, self._change = self._change(), None
                    board = self._to_board()
                continue
            for source, sink, way in ((host, board, TO_BOARD), (board, host, TO_HOST)):
                left = self._left[way]
                if source not in ready or left == 0:
                    continue
                data = b""
                with contextlib.suppress(OSError):
                    data = source.recv(65536 if left is None else left)
                if not data:
                    return board
                if left is not None:
                    self._left[way] = left - len(data)
                if not self.stopped:
                    with contextlib.suppress(OSError):
                        sink.sendall(data)
        return board
