# SPDX-License-Identifier: BSD-3-Clause
"""A node on a plane that keeps everything, a board behind a cable that loses bytes, and the spec of both."""

from __future__ import annotations

import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from select import select
from urllib.parse import urlsplit

from unit.ros.plane import MemoryPlane

from unitylink import connect
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.ros import plan_interface
from unitylink.ros.node import Options, RobotNode
from unitylink.simulate import Board
from unitylink.spec.model import Spec

TEXT = """
enum Mode : u2 { idle = 0; run = 1; }
bits Flags : u8 { on: bool @ 0; heat: u6 @ 6..1 (UNIT="K", SCALE=0.5); }
public rig() {
   j[2]: axis() @ (0x10+i*8, 0x11+i*8, 0x12+i*8);
   @mode = 0x0: Mode READWRITE(INITIAL=1, SAFE=0, PUBLISH(1,10));
   @flags = 0x1: Flags READ(PUBLISH(1,10));
   @go = 0x2: u8 PULSE();
   @ros(type="UInt16") @slow = 0x3: u16 READ(PUBLISH(1,50));
}
axis(): @ (p,v,s) {
   @pos = p: i16 READ(UNIT="rad", SCALE=0.001, PUBLISH(1,10));
   @vel = v: i16 READ(UNIT="rad/s", SCALE=0.01, PUBLISH(1,10));
   @pos_sp = s: i16 WRITE(UNIT="rad", SCALE=0.001, MIN=-1, MAX=1, SAFE=0.25);
}
"""


@contextmanager
def running(spec: Spec, url: str, **options: object) -> Iterator[tuple[RobotNode, MemoryPlane]]:  # type: ignore[valid-type]
    plane = MemoryPlane()
    given = Options(retry_s=0.02, **options)  # type: ignore[arg-type]

    def build(link: Link) -> object:
        return load_spec_objects(spec, link)

    node = RobotNode(plan_interface(spec), plane, lambda: connect(url, reconnect="auto"), build, given)  # type: ignore[arg-type]
    try:
        yield node, plane
    finally:
        node.close()


class Still:
    """A plant that does not change the registers."""

    period_s = 0.001

    def attach(self, spec: object, registers: object) -> None: ...
    def step(self, time_s: float) -> None: ...


def becomes(holds: Callable[[], bool]) -> None:
    deadline = time.monotonic() + 30
    while not holds():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.01)


class Cable:
    """A wire to a board.

    Its end at the host stays a working port while bytes are lost (`cut`) or late (`held`). It also stays
    while another board replaces this one, as when an FPGA is configured again.
    """

    def __init__(self, board: Board) -> None:
        self.cut = self.held = False
        self._board = self._to(board)
        self._listening = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._listening.getsockname()[1]}"
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    @staticmethod
    def _to(board: Board) -> socket.socket:
        where = urlsplit(board.url)
        return socket.create_connection((where.hostname, where.port))

    def replace(self, board: Board) -> None:
        old, self._board = self._board, self._to(board)
        old.close()

    def _serve(self) -> None:
        host: socket.socket | None = None
        while not self._stop.is_set():
            board = self._board
            ends = [self._listening] + ([host] if host else []) + ([] if self.held else [board])
            ready, _, _ = select(ends, [], [], 0.01)
            for end in ready:
                if end is self._listening:
                    if host is not None:  # the board has not read the end of it yet
                        host.close()
                    host, _ = self._listening.accept()
                    continue
                with suppress(OSError):  # the board is being replaced
                    data = end.recv(65536)
                    if end is host and not data:
                        host.close()
                        host = None
                    elif not self.cut and host is not None:
                        (board if end is host else host).sendall(data)
        for end in (self._listening, self._board, host):
            if end is not None:
                end.close()

    def __enter__(self) -> Cable:
        return self

    def __exit__(self, *_: object) -> None:
        self._stop.set()
        self._thread.join()
