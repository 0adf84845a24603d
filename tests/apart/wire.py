# SPDX-License-Identifier: BSD-3-Clause
"""A bad wire as a program of its own: python wire.py KIND LISTEN TARGET SEED FAULT=RATE...

It knows nothing of Unity-Link. It passes bytes or datagrams between LISTEN and TARGET, both ways. To each
piece that it has read it does what the rates say. KIND is `tcp` or `udp`, between ports of this machine, or
`pty`. With `pty` it makes a terminal at the path LISTEN and opens the one at TARGET.

    split   a piece goes on in several, with others let by in between
    lose    bytes of a stream, or a datagram, are gone
    double  bytes of a stream, or a datagram, come twice
    flip    a bit is wrong
    cut     a datagram ends too soon; a stream is broken behind half a piece, with a reset
    late    a datagram comes up to LATE_S later, and others overtake it
    stall   nothing passes, that way, for up to STALL_S

The last line of output says how often each fault was made.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import random
import socket
import struct
import sys
import termios
import tty
from collections import Counter
from collections.abc import Awaitable, Callable
from pathlib import Path

LATE_S = 0.03
STALL_S = 0.06
PIECE = 4096
Send = Callable[[bytes], Awaitable[None]]


class Broken(Exception):
    """The line is cut."""


class Faults:
    """The faults that a piece meets.

    The same seed draws the same faults, but the machine decides when pieces come.
    """

    def __init__(self, seed: int, rates: dict[str, float]) -> None:
        self.random = random.Random(seed)
        self.rates = rates
        self.done: Counter[str] = Counter()

    def meets(self, fault: str) -> bool:
        if self.random.random() >= self.rates.get(fault, 0.0):
            return False
        self.done[fault] += 1
        return True

    def flipped(self, piece: bytes) -> bytes:
        spoiled = bytearray(piece)
        spoiled[self.random.randrange(len(spoiled))] ^= 1 << self.random.randrange(8)
        return bytes(spoiled)

    def _part(self, piece: bytes) -> tuple[int, int]:
        first = self.random.randrange(len(piece))
        return first, min(len(piece), first + self.random.choice((1, 1, 2, 5, 40)))

    async def stream(self, piece: bytes, send: Send) -> None:
        """Pass a piece of a stream. Raises Broken."""
        if self.meets("stall"):
            await asyncio.sleep(self.random.random() * STALL_S)
        if self.meets("lose"):
            first, last = self._part(piece)
            piece = piece[:first] + piece[last:]
        if piece and self.meets("double"):
            first, last = self._part(piece)
            piece = piece[:last] + piece[first:last] * self.random.choice((1, 1, 2)) + piece[last:]
        if piece and self.meets("flip"):
            piece = self.flipped(piece)
        if piece and self.meets("cut"):
            await send(piece[: self.random.randrange(len(piece))])
            raise Broken
        if self.meets("split"):
            while len(piece) > 1 and self.random.random() < 0.8:
                count = self.random.randrange(1, len(piece))
                await send(piece[:count])
                piece = piece[count:]
                await asyncio.sleep(self.random.choice((0, 0, 0.0005)))
        await send(piece)

    def datagram(self, piece: bytes, send: Callable[[bytes], None]) -> None:
        """Pass a datagram: now, later, twice, damaged or never."""
        if self.meets("lose"):
            return
        if piece and self.meets("flip"):
            piece = self.flipped(piece)
        if piece and self.meets("cut"):
            piece = piece[: self.random.randrange(len(piece))]
            if not piece:
                return  # an empty datagram has a meaning, and no network turns another one into it
        loop = asyncio.get_running_loop()
        for _ in range(2 if self.meets("double") else 1):
            if self.meets("late"):
                loop.call_later(self.random.random() * LATE_S, send, piece)
            else:
                send(piece)


# ---- streams between ports


async def _pump(faults: Faults, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
    async def send(piece: bytes) -> None:
        writer.write(piece)
        await writer.drain()

    while piece := await reader.read(PIECE):
        await faults.stream(piece, send)


async def tcp(faults: Faults, listen: str, target: str) -> None:
    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        ends = [writer]
        with contextlib.suppress(OSError, Broken):
            far, back = await asyncio.open_connection("127.0.0.1", int(target))
            ends.append(back)
            ways = {
                asyncio.ensure_future(_pump(faults, reader, back)),
                asyncio.ensure_future(_pump(faults, far, writer)),
            }
            _, others = await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
            for other in others:
                other.cancel()
            await asyncio.gather(*ways, return_exceptions=True)
        for end in ends:
            with contextlib.suppress(OSError):  # closed already
                reset = struct.pack("ii", 1, 0)  # and what is under way is lost
                end.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, reset)
            end.transport.abort()

    await asyncio.start_server(serve, "127.0.0.1", int(listen))


# ---- datagrams between ports


async def udp(faults: Faults, listen: str, target: str) -> None:
    """Serve one host at a time, as a router does. What the board sends goes to the host that sent last."""
    loop = asyncio.get_running_loop()
    here = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    here.bind(("127.0.0.1", int(listen)))
    there = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)  # not connected, so a closed port is no error
    there.bind(("127.0.0.1", 0))
    board = ("127.0.0.1", int(target))
    hosts: list[tuple[str, int]] = []
    for one in (here, there):
        one.setblocking(False)

    def forward(piece: bytes) -> None:
        with contextlib.suppress(OSError):
            there.sendto(piece, board)

    def back(piece: bytes) -> None:
        if hosts:
            with contextlib.suppress(OSError):
                here.sendto(piece, hosts[0])

    def from_host() -> None:
        with contextlib.suppress(OSError):
            piece, host = here.recvfrom(65536)
            hosts[:] = [host]
            faults.datagram(piece, forward)

    def from_board() -> None:
        with contextlib.suppress(OSError):
            faults.datagram(there.recv(65536), back)

    loop.add_reader(here, from_host)
    loop.add_reader(there, from_board)


# ---- terminals


def _raw_terminal(path: str) -> int | None:
    """Open a terminal. Return None if it is gone, or goes away meanwhile."""
    try:
        terminal = os.open(path, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    except OSError:
        return None
    try:
        tty.setraw(terminal, termios.TCSANOW)
    except termios.error:
        os.close(terminal)
        return None
    return terminal


async def _terminal(faults: Faults, listen: str, target: str) -> None:
    """One life of the line. It ends when the line is cut, or the board's terminal is gone."""
    loop = asyncio.get_running_loop()
    while (far := _raw_terminal(target)) is None:  # wait while the board is not there
        await asyncio.sleep(0.005)
    master, slave = os.openpty()  # the slave stays open here, so the line does not end when a host leaves
    os.set_blocking(master, False)
    tty.setraw(slave, termios.TCSANOW)
    Path(listen).unlink(missing_ok=True)
    Path(listen).symlink_to(os.ttyname(slave))
    over: asyncio.Future[None] = loop.create_future()

    async def way(source: int, sink: int) -> None:
        ready = asyncio.Event()
        loop.add_reader(source, ready.set)

        async def send(piece: bytes) -> None:
            while piece:
                try:
                    piece = piece[os.write(sink, piece) :]
                except BlockingIOError:
                    await asyncio.sleep(0.001)

        try:
            while True:
                await ready.wait()
                ready.clear()
                try:
                    piece = os.read(source, PIECE)
                except BlockingIOError:
                    continue
                if not piece:
                    return
                await faults.stream(piece, send)
        finally:
            loop.remove_reader(source)
            if not over.done():
                over.set_result(None)

    ways = [asyncio.ensure_future(way(master, far)), asyncio.ensure_future(way(far, master))]
    await over
    for one in ways:
        one.cancel()
    await asyncio.gather(*ways, return_exceptions=True)
    # The next terminal that anybody opens may get the number of this one.
    Path(listen).unlink(missing_ok=True)
    for end in (far, master, slave):
        os.close(end)


_running: set[asyncio.Future[None]] = set()


async def pty(faults: Faults, listen: str, target: str) -> None:
    async def lives() -> None:
        while True:
            await _terminal(faults, listen, target)

    _running.add(asyncio.ensure_future(lives()))


async def main(kind: str, listen: str, target: str, faults: Faults) -> None:
    over = asyncio.Event()
    # End of input: the program that started this one wants it to end, or is gone.
    asyncio.get_running_loop().add_reader(sys.stdin, over.set)
    await {"tcp": tcp, "udp": udp, "pty": pty}[kind](faults, listen, target)
    print("ready", flush=True)
    await over.wait()
    print(json.dumps(faults.done), flush=True)
    os._exit(0)


if __name__ == "__main__":
    _, kind, listen, target, seed, *rates = sys.argv
    chosen = {name: float(rate) for name, rate in (pair.split("=") for pair in rates)}
    asyncio.run(main(kind, listen, target, Faults(int(seed), chosen)))
