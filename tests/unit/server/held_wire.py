# SPDX-License-Identifier: BSD-3-Clause
"""A TCP line to a board that holds everything back while a test wants it."""

from __future__ import annotations

import contextlib
import socket
import threading
import time
from collections.abc import Callable, Iterator
from urllib.parse import urlsplit


class HeldWire:
    """Forwards bytes to the board while `open_` is set. What comes back is always forwarded.

    `waits` says whether bytes wait for that. `delay_s` says how late some bytes are. Frames of the kind
    `loses` are lost, and counted.
    """

    def __init__(self, board_url: str) -> None:
        self.waits = False
        self.delay_s: Callable[[bytes], float] = lambda _: 0.0
        self.loses = -1
        self.lost = 0
        self.open_ = threading.Event()
        self.open_.set()
        place = urlsplit(board_url)
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._listener.getsockname()[1]}"
        self._board = socket.create_connection((place.hostname, place.port))
        self._board.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        threading.Thread(target=self._serve, name="held wire", daemon=True).start()

    def _serve(self) -> None:
        with contextlib.suppress(OSError):
            host, _ = self._listener.accept()
            host.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threading.Thread(target=self._forward, args=(self._board, host), daemon=True).start()
            self._forward(host, self._board, held=True)

    def _forward(self, source: socket.socket, sink: socket.socket, *, held: bool = False) -> None:
        with contextlib.suppress(OSError), source, sink:
            while data := source.recv(65536):
                if held:
                    time.sleep(self.delay_s(data))
                    self.waits = not self.open_.is_set()
                    self.open_.wait()
                    self.waits = False
                    data = b"\0".join(filter(self._passes, data.split(b"\0")))
                sink.sendall(data)

    def _passes(self, frame: bytes) -> bool:
        lost = self.loses >= 0 and frame[:1] == bytes([self.loses])
        self.lost += lost
        return not lost

    def close(self) -> None:
        self.open_.set()
        for one in (self._listener, self._board):
            with contextlib.suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)
            one.close()


@contextlib.contextmanager
def held(wire: HeldWire) -> Iterator[None]:
    """Hold the wire within a `with` block."""
    wire.open_.clear()
    try:
        yield
    finally:
        wire.open_.set()
