# SPDX-License-Identifier: BSD-3-Clause
"""An RS-485 pair on a pseudo-terminal.

The nodes follow docs/protocol.md, section 10, each with a device on TCP.

Every byte on the pair is heard by all others. The master hears its own bytes too if its adapter does.
"""

from __future__ import annotations

import itertools
import os
import re
import select
import socket
import threading
import time
import tty
from collections.abc import Mapping
from pathlib import Path
from typing import Protocol

BORDER = 0
POLL = 0x40
_PATIENCE_S = 0.02  # longest wait for a node that was polled, whose device may still be at work


def token(node: int, *, poll: bool) -> bytes:
    """Return the three bytes that say for which node the next frames are, or which node sends now.

    >>> token(3, poll=False).hex(), token(0, poll=True).hex()
    ('03ca00', '40c900')
    """
    first = node | (POLL if poll else 0)
    rest = 0
    for bit in range(6, -1, -1):
        feedback = (rest >> 6 ^ first >> bit) & 1
        rest = rest << 1 & 0x7F ^ (0x45 if feedback else 0)
    return bytes((first, 0x80 | rest, BORDER))


class PairNode(Protocol):
    """Something that listens to a pair, and sends when it is its turn."""

    def hear(self, data: bytes) -> None: ...
    def say(self) -> bytes: ...
    def fileno(
        self,
    ) -> int: ...  # readable when there is something to send; -1 if it must be asked after a poll
    def close(self) -> None: ...


class ModelNode:
    """A node whose device exchanges frames over TCP."""

    def __init__(self, number: int, address: tuple[str, int]) -> None:
        self.number = number
        self._asked = False  # frames for us have come since we last sent
        self._device = socket.create_connection(address)
        self._device.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._message = b""
        self._coming = b""
        self._selected = self._polled = False

    def hear(self, data: bytes) -> None:
        for byte in data:
            if byte != BORDER:
                self._message += bytes((byte,))
                continue
            message, self._message = self._message, b""
            if message[:1] >= b"\x80":
                if self._selected:
                    self._asked = True
                    self._device.sendall(b"\0" + message + b"\0")
            elif message:
                self._selected = message + b"\0" == token(self.number, poll=False)
                self._polled = message + b"\0" == token(self.number, poll=True)

    def say(self) -> bytes:
        if not self._polled:
            return b""
        self._polled = False
        until = time.monotonic() + (_PATIENCE_S if self._asked else 0)
        while True:
            ready, _, _ = select.select([self._device], [], [], 0.001 if self._asked else 0)
            if ready:
                self._coming += self._device.recv(65536)
            end = self._coming.rfind(b"\0") + 1
            if end or time.monotonic() > until:
                break
        self._asked = False
        frames, self._coming = self._coming[:end], self._coming[end:]
        return b"\0" + token(self.number, poll=False) + frames + token(0, poll=True)

    def fileno(self) -> int:
        return -1

    def close(self) -> None:
        self._device.close()


class WireNode:
    """A complete node on TCP, byte by byte: it hears everything on the pair, and sends when it likes."""

    def __init__(self, address: tuple[str, int]) -> None:
        self._device = socket.create_connection(address)
        self._device.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def hear(self, data: bytes) -> None:
        self._device.sendall(data)

    def say(self) -> bytes:
        try:
            return self._device.recv(65536, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return b""

    def fileno(self) -> int:
        return self._device.fileno()

    def close(self) -> None:
        self._device.close()


class Pair:
    """Nodes on a pseudo-terminal. `path` is its name, `collisions` counts what nodes sent out of turn."""

    def __init__(self, nodes: Mapping[int, PairNode], path: Path, *, echo: bool) -> None:
        self.path = path
        self.collisions = 0
        self.dead: set[int] = set()  # nodes that hear but send nothing
        self.flip = 0  # one of so many bytes of the master has a flipped bit; 0 for none
        self._nodes = nodes
        self._echo = echo
        self._count = 0
        self._turn = 0  # the node that was polled last
        self._ours, self._theirs = os.openpty()
        tty.setraw(self._theirs)
        path.symlink_to(os.ttyname(self._theirs))
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._carry)
        self._thread.start()

    def _carry(self) -> None:
        speaking = [node.fileno() for node in self._nodes.values() if node.fileno() >= 0]
        while not self._stop.is_set():
            ready, _, _ = select.select([self._ours, *speaking], [], [], 0.05)
            alive = {number: node for number, node in self._nodes.items() if number not in self.dead}
            data = self._damaged(os.read(self._ours, 65536)) if self._ours in ready else b""
            if self._echo and data:
                os.write(self._ours, data)
            for piece in self._turns(data):  # the polled node answers before more is heard
                for node in alive.values():
                    node.hear(piece)
                self._turn = next((n for n in alive if piece.endswith(token(n, poll=True))), self._turn)
                self._answer(alive)

    def _answer(self, alive: Mapping[int, PairNode]) -> None:
        answers = {number: answer for number, node in alive.items() if (answer := node.say())}
        for number, answer in answers.items():
            self.collisions += number != self._turn
            for node in alive.values():
                if node is not alive[number]:
                    node.hear(answer)
            os.write(self._ours, answer)

    def _turns(self, data: bytes) -> list[bytes]:
        """Cut the master's bytes after each poll."""
        ends = sorted(
            match.end()
            for number in self._nodes
            for match in re.finditer(re.escape(token(number, poll=True)), data)
        )
        cuts = [0, *ends, len(data)]
        return [data[begin:end] for begin, end in itertools.pairwise(cuts) if begin < end or not data]

    def _damaged(self, data: bytes) -> bytes:
        damaged = bytearray(data)
        for place in range(len(damaged)):
            self._count += 1
            if self.flip and self._count % self.flip == 0:
                damaged[place] ^= 1 << self._count % 8
        return bytes(damaged)

    def unplug(self) -> None:
        """Close it as when an adapter is pulled out."""
        self.close()

    def close(self) -> None:
        if not self._stop.is_set():
            self._stop.set()
            self._thread.join()
            self.path.unlink(missing_ok=True)  # the next terminal that is opened may have its number
            os.close(self._ours)
            os.close(self._theirs)
            for node in self._nodes.values():
                node.close()
