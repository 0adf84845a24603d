# SPDX-License-Identifier: BSD-3-Clause
"""A wire that counts bytes and makes faults, as a process: `python -m unitylink_lab.experiments.wire
PTY|HOST:PORT`.

It carries bytes between a pty of its own and PTY, or datagrams between a port of its own and HOST:PORT. It
prints the address of its own end. Each line on standard input is a command:

    bytes                    answers with the bytes to and from the device since last asked
    freeze, thaw             keeps all that the device says; lets it through again
    flip [device]            inverts the lowest bit of the third byte from the end of the next message
    cut [device]             takes the first byte away from it
    lose [device]            takes all of it away
    late [device] SECONDS    holds it, and on a pty all that follows, for so long
    settle SECONDS           answers when the fault has met its message, and what was late is through

"The next message" is the next one to the host, or with `device` the next one to the device.
"""

from __future__ import annotations

import os
import pty
import select
import socket
import sys
import time
import tty
from collections import deque
from typing import Protocol

_CHUNK = 65536
# A message on a pty ends after this time, or when the other side sends or a command comes. Some clients write
# one message in pieces. A fault must hit the whole message, but not its repetition.
_QUIET_S = 0.02
FAULTS = ("flip", "cut", "lose", "late")


class End(Protocol):
    """An end of the wire: it takes messages and gives them."""

    stream: bool  # true for bytes in order without borders, false for datagrams

    def fileno(self) -> int: ...
    def take(self) -> bytes: ...
    def give(self, data: bytes) -> None: ...


class Pty:
    """An end that is a terminal's descriptor."""

    stream = True

    def __init__(self, descriptor: int) -> None:
        self._descriptor = descriptor

    def fileno(self) -> int:
        return self._descriptor

    def take(self) -> bytes:
        return os.read(self._descriptor, _CHUNK)

    def give(self, data: bytes) -> None:
        os.write(self._descriptor, data)


class Udp:
    """An end that is a socket. Without `peer` it answers the last sender."""

    stream = False

    def __init__(self, peer: tuple[str, int] | None = None) -> None:
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self._socket.bind(("127.0.0.1", 0))
        self._peer = peer

    @property
    def name(self) -> str:
        return f"127.0.0.1:{self._socket.getsockname()[1]}"

    def fileno(self) -> int:
        return self._socket.fileno()

    def take(self) -> bytes:
        try:
            data, self._peer = self._socket.recvfrom(_CHUNK)
        except ConnectionRefusedError:  # nobody listened when the earlier bytes were sent
            return b""
        return data

    def give(self, data: bytes) -> None:
        if self._peer is not None:
            self._socket.sendto(data, self._peer)


class Way:
    """One direction of the wire."""

    def __init__(self, source: End, sink: End) -> None:
        self.source, self._sink = source, sink
        self.carried = 0
        self.frozen = False
        self._fault, self._late_s = "", 0.0
        self._whole = b""  # the message for which a fault waits, so far
        self._held: deque[tuple[float, bytes]] = deque()

    @property
    def busy(self) -> bool:
        return bool(self._fault or self._held)

    def arm(self, fault: str, late_s: float) -> None:
        self._fault, self._late_s = fault, late_s

    def carry(self) -> None:
        """Take the bytes that have come, and pass them on unless a fault removes them."""
        data = self.source.take()
        if self.frozen or not data:
            return
        self.carried += len(data)
        if not self._fault:
            self._pass(data)
            return
        self._whole += data
        if not self.source.stream:
            self._spoil()

    def due_s(self) -> float | None:
        """Return the time until something has to be done here, or None."""
        if self._whole:
            return _QUIET_S
        return max(0.0, self._held[0][0] - time.monotonic()) if self._held else None

    def quiet(self) -> None:
        """Do what is due by the clock: end a message, release a late one."""
        if self._whole:
            self._spoil()
        while self._held and self._held[0][0] <= time.monotonic():
            self._sink.give(self._held.popleft()[1])

    def _pass(self, data: bytes) -> None:
        if self._held and self.source.stream:  # bytes must stay in order
            self._held.append((self._held[-1][0], data))
        else:
            self._sink.give(data)

    def _spoil(self) -> None:
        data, fault, self._whole, self._fault = bytearray(self._whole), self._fault, b"", ""
        if fault == "late":
            self._held.append((time.monotonic() + self._late_s, bytes(data)))
            return
        if fault == "lose":
            return
        if fault == "flip":
            data[max(0, len(data) - 3)] ^= 1
        elif fault == "cut":
            del data[0]
        self._pass(bytes(data))


class Wire:
    """Two ends and both ways between them."""

    def __init__(self, host: End, device: End) -> None:
        self.to_device, self.to_host = Way(host, device), Way(device, host)

    def obey(self, command: str) -> str:
        """Do the command in a line, and return the answer.

        >>> Wire(Pty(0), Pty(1)).obey("bytes")
        '0 0'
        """
        word, *rest = command.split() or [""]
        if word == "bytes":
            told = f"{self.to_device.carried} {self.to_host.carried}"
            self.to_device.carried = self.to_host.carried = 0
            return told
        if word in ("freeze", "thaw"):
            self.to_host.frozen = word == "freeze"
            return "ok"
        if word == "settle":
            end = time.monotonic() + float(rest[0])
            while (self.to_device.busy or self.to_host.busy) and time.monotonic() < end:
                self.turn([], _QUIET_S)
            return "busy" if self.to_device.busy or self.to_host.busy else "ok"
        way = self.to_device if rest[:1] == ["device"] else self.to_host
        if word not in FAULTS:
            return f"no command {command!r}"
        way.arm(word, float(rest[-1]) if word == "late" else 0.0)
        return "ok"

    def turn(self, others: list[int], most_s: float | None = None) -> bool:
        """Wait for bytes for at most `most_s`, and carry them.

        Return whether one of `others` can be read.
        """
        ways = (self.to_device, self.to_host)
        waits = [wait_s for wait_s in (*(way.due_s() for way in ways), most_s) if wait_s is not None]
        ready, _, _ = select.select(
            [way.source.fileno() for way in ways] + others, [], [], min(waits, default=None)
        )
        for way in ways:
            if way.source.fileno() in ready:
                way.carry()
            else:
                way.quiet()
        return any(other in ready for other in others)


def main() -> None:
    """Carry until standard input ends."""
    place = sys.argv[1]
    host: End
    device: End
    if place.startswith("/"):
        own, own_end = pty.openpty()  # the second end stays open, so that a client may come and go
        descriptor = os.open(place, os.O_RDWR | os.O_NOCTTY)
        for each in (own_end, descriptor):
            tty.setraw(each)
        host, device, name = Pty(own), Pty(descriptor), os.ttyname(own_end)
    else:
        address, _, port = place.rpartition(":")
        host, device = Udp(), Udp((address, int(port)))
        name = host.name
    wire = Wire(host, device)
    print(name, flush=True)
    while True:
        if wire.turn([sys.stdin.fileno()]):
            line = sys.stdin.readline()
            if not line:
                return
            print(wire.obey(line.strip()), flush=True)


if __name__ == "__main__":
    main()
