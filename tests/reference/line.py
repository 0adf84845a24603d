# SPDX-License-Identifier: BSD-3-Clause
"""A reference device at the end of a faulty line."""

from __future__ import annotations

import random
import socket
import threading

from .device import ReferenceDevice
from .settings import Settings


class Line:
    """A reference device behind a line that damages, loses, doubles and cuts frames.

    It also resets the device.
    """

    def __init__(self, seed: int) -> None:
        self.random = random.Random(seed)
        self.rate = self.random.choice([0.0, 0.02, 0.1])
        self.reset_rate = self.random.choice([0.0, 0.0, 0.01])
        self.device = ReferenceDevice(Settings(window=8))
        self.calm = False
        ours, theirs = socket.socketpair()
        self._theirs = theirs
        self.url = f"fd:{ours.detach()}?protocol=framed&timeout=0.2&attempts=20"
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self) -> None:
        with self._theirs:
            self._answer()

    def _answer(self) -> None:
        while data := self._theirs.recv(65536):
            if self.random.random() < self.reset_rate and not self.calm:
                self.device = ReferenceDevice(Settings(window=8), self.device.bus, self.device.nonce)
            answer = self.bad(self.device.feed(self.bad(data)))
            try:
                self._theirs.sendall(answer)
            except BrokenPipeError:
                return

    def bad(self, data: bytes) -> bytes:
        if self.calm:
            return data
        pieces = data.split(b"\0")
        return b"\0".join([*map(self._piece, pieces[:-1]), pieces[-1]])

    def _piece(self, piece: bytes) -> bytes:
        if not piece or self.random.random() >= self.rate:
            return piece
        at = self.random.randrange(len(piece))
        flipped = piece[:at] + bytes([piece[at] ^ 1 << self.random.randrange(8)]) + piece[at + 1 :]
        return self.random.choice([b"", flipped, piece[:at], piece + b"\0" + piece])
