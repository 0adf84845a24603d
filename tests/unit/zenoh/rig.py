# SPDX-License-Identifier: BSD-3-Clause
"""A virtual board, its bridge, and a Zenoh router, all in this process and on loopback."""

from __future__ import annotations

import select
import socket
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from unitylink.server.audit import Audit
from unitylink.server.robot import Robot
from unitylink.server.scopes import Rights
from unitylink.server.tokens import Tokens, User, digest, new_token
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import load
from unitylink.spec.model import Spec
from unitylink.zenoh.bridge.bridge import Bridge
from unitylink.zenoh.keys import Keys
from unitylink.zenoh.session import Network
from unitylink.zenoh.spec_files import pack_spec

TEXT = """
public arm() {
   j1: joint() @ (0x10);
   j2: joint() @ (0x20);
   @hits = 0x30: READWRITE();
   @stamp = 0x31: u32 WRITE(SAFE=0);
}
joint() : @ (a) {
   @goal = a: i16 WRITE(UNIT="rad", SCALE=0.001, MIN=-1.5, MAX=1.5, SAFE=0);
   @angle = a+1: i16 READ(UNIT="rad", SCALE=0.001, PUBLISH(100 Hz));
}
"""
GOAL, ANGLE, HITS, STAMP = 0x10, 0x11, 0x30, 0x31
BASE_S = time.monotonic()


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as one:
        port: int = one.getsockname()[1]
        return port


def until(true: Callable[[], Any], within_s: float = 10.0) -> Any:
    """Wait until something is true, and return it."""
    limit_s = time.monotonic() + within_s
    while not (value := true()):
        assert time.monotonic() < limit_s, f"not within {within_s} s"
        time.sleep(0.005)
    return value


class Oracle:
    """The machine behind the board: it notes each value of `stamp`, and when it saw it first."""

    period_s = 0.001

    def __init__(self) -> None:
        self.seen: list[tuple[float, int]] = []

    def attach(self, spec: Spec | None, registers: Any) -> None:
        self._registers = registers
        self._registers[ANGLE] = 250

    def step(self, time_s: float) -> None:
        value = int(self._registers[STAMP])
        if not self.seen or self.seen[-1][1] != value:
            self.seen.append((time.monotonic(), value))


class Gap:
    """A way to a port that can be stopped, in each direction. What is under way meanwhile comes later."""

    def __init__(self, port: int) -> None:
        self._to = port
        self._door = socket.create_server(("127.0.0.1", 0))
        self.port: int = self._door.getsockname()[1]
        self.there, self.back = threading.Event(), threading.Event()
        self.there.set()
        self.back.set()
        self._ends: list[socket.socket] = []
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self) -> None:
        while True:
            try:
                near, _ = self._door.accept()
                far = socket.create_connection(("127.0.0.1", self._to))
            except OSError:
                return
            self._ends += [near, far]
            for source, target, open_ in ((near, far, self.there), (far, near, self.back)):
                threading.Thread(target=self._carry, args=(source, target, open_), daemon=True).start()

    def _carry(self, source: socket.socket, target: socket.socket, open_: threading.Event) -> None:
        try:
            while select.select([source], [], []) and (data := source.recv(65536)):
                open_.wait()
                target.sendall(data)
        except (OSError, ValueError):
            pass
        for end in (source, target):
            _end(end)

    def lose(self) -> None:
        """Lose the connections, with all that is under way. New ones can be made."""
        ends, self._ends = self._ends, []
        for end in ends:
            _end(end)
        self.there.set()
        self.back.set()

    def close(self) -> None:
        """Cut all ways."""
        self.there.set()
        self.back.set()
        for end in [self._door, *self._ends]:
            _end(end)


def _end(one: socket.socket) -> None:
    """Close a socket. A thread that waits for it would keep it open, if it were not shut down before."""
    with suppress(OSError):
        one.shutdown(socket.SHUT_RDWR)
    one.close()


@dataclass
class Rig:
    """Everything, and how to reach it. `port` is the router's."""

    spec: Spec
    file: Path
    oracle: Oracle
    board_port: int
    port: int
    robot: Robot
    token: str
    reading: str
    board: Board
    stack: ExitStack
    bridge: Bridge = field(init=False)

    @property
    def network(self) -> Network:
        return Network(connect=f"tcp/127.0.0.1:{self.port}")

    def url(self, more: str = "", port: int | None = None) -> str:
        return f"zenoh:lab/arm1?connect=tcp/127.0.0.1:{port or self.port}{more}"

    def start(self) -> Bridge:
        """Start the bridge, which is the router, too."""
        self.bridge = self.made(Network(listen=f"tcp/127.0.0.1:{self.port}"))
        until(lambda: self.bridge.state()["away"] == "")
        return self.bridge

    def made(self, network: Network, publishing: Network | None = None) -> Bridge:
        return Bridge(
            self.robot,
            Keys("lab/arm1"),
            network,
            publishing or self.network,
            pack_spec(self.file, "arm"),
            token=self.token,
            reading=self.reading,
        )

    def new_board(self, **configuration: Any) -> Board:
        """Put another board where the last one was."""
        made = BoardConfiguration.for_spec(self.spec, **configuration)
        self.board = self.stack.enter_context(
            Board(self.spec, configuration=made, plant=self.oracle, endpoint=f"tcp:{self.board_port}")
        )
        return self.board


@contextmanager
def rigged(folder: Path) -> Iterator[Rig]:
    """Give a rig whose bridge runs."""
    file = folder / "arm.ul"
    file.write_text(TEXT)
    spec, oracle = load(file), Oracle()
    token, reading = new_token(), new_token()
    users = [
        (token, User("zenoh", Rights.of(["write", "arm"]))),
        (reading, User("reads", Rights.of(["read"]))),
    ]
    tokens = Tokens([(digest(one), user) for one, user in users])
    with ExitStack() as stack:
        board_port = free_port()
        audit = Audit(lambda line: None)
        robot = Robot("arm", f"tcp://127.0.0.1:{board_port}", spec, tokens, audit)
        board = stack.enter_context(Board(spec, plant=oracle, endpoint=f"tcp:{board_port}"))
        stack.callback(robot.close)
        robot.start()
        rig = Rig(spec, file, oracle, board_port, free_port(), robot, token, reading, board, stack)
        rig.start()
        stack.callback(lambda: rig.bridge.close())  # noqa: PLW0108  the last one that was started
        yield rig
