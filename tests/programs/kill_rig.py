# SPDX-License-Identifier: BSD-3-Clause
"""Servers that are killed at a chosen byte, and a board that keeps a journal of its output.

`python kill_rig.py` is the mother of the servers: it has imported all, and forks one for each line that it
reads.
So a server starts in milliseconds.
"""

from __future__ import annotations

import contextlib
import json
import os
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from urllib.parse import urlsplit

from unitylink.simulate import Board, Registers
from unitylink.spec import compile_text
from unitylink.spec.model import Spec

TEXT = "public arm() { @target = 0x1A: i32 WRITE(SAFE=0); @angle = 0x12: i32 READ(); }"
TARGET = 0x1A
TOKEN = "all"


def spec_of_rig() -> Spec:
    spec = compile_text(TEXT, "arm.ul").spec
    assert spec is not None
    return spec


class Journal:
    """A plant that notes each new value of the target, as the board's own clock sees it."""

    period_s = 0.001

    def __init__(self) -> None:
        self.values: list[int] = [0]

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        self._registers = registers

    def step(self, time_s: float) -> None:
        value = self._registers[TARGET]
        if value != self.values[-1]:
            self.values.append(value)


class FatalWire:
    """Forwards bytes between servers and a board. After a chosen number of bytes it kills the server."""

    def __init__(self, board_url: str) -> None:
        self._place = urlsplit(board_url)
        self._lock = threading.Lock()
        self._victim, self._left = 0, [0, 0]
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.url = f"tcp://127.0.0.1:{self._listener.getsockname()[1]}"
        threading.Thread(target=self._serve, daemon=True).start()

    def kill_after(self, victim: int, to_board: bool, count: int) -> None:
        """Kill the process `victim` when so many more bytes have gone in one direction."""
        with self._lock:
            self._victim = victim
            self._left = [count, 1 << 60] if to_board else [1 << 60, count]

    def close(self) -> None:
        self._listener.close()

    def _serve(self) -> None:
        while True:
            try:
                server, _ = self._listener.accept()
            except OSError:
                return
            board = socket.create_connection((self._place.hostname, self._place.port))
            pairs = ((server, board, 0), (board, server, 1))
            for one in (server, board):
                one.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
            threads = [threading.Thread(target=self._pump, args=pair, daemon=True) for pair in pairs]
            for thread in threads:
                thread.start()
            for thread in threads:  # the board takes the next server when this one is gone
                thread.join()
            server.close()
            board.close()

    def _pump(self, source: socket.socket, sink: socket.socket, way: int) -> None:
        with contextlib.suppress(OSError):
            while data := source.recv(65536):
                with self._lock:
                    count = min(len(data), self._left[way]) if self._victim else len(data)
                    self._left[way] -= len(data)
                    dead = self._victim != 0 and self._left[way] <= 0
                sink.sendall(data[:count])
                if dead:
                    self._kill()
                    sink.sendall(data[count:])
        for one in (source, sink):
            with contextlib.suppress(OSError):
                one.shutdown(socket.SHUT_RDWR)

    def _kill(self) -> None:
        with self._lock:
            victim, self._victim = self._victim, 0
        if victim:
            os.kill(victim, signal.SIGKILL)


class Mother:
    """Starts servers quickly."""

    def __init__(self) -> None:
        program = [sys.executable, "-m", "tests.programs.kill_rig"]
        self._process = subprocess.Popen(program, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)

    def start(self, board_url: str) -> tuple[int, str]:
        """Return the process of a new server, and the place where it listens."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.write(board_url + "\n")
        self._process.stdin.flush()
        told = json.loads(self._process.stdout.readline())
        return told["pid"], told["place"]

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()


@dataclass
class KillRig:
    mother: Mother
    wire: FatalWire
    board: Board
    journal: Journal


@contextlib.contextmanager
def kill_rig() -> Iterator[KillRig]:
    journal, mother = Journal(), Mother()
    with Board(spec_of_rig(), plant=journal, endpoint="tcp") as board:
        wire = FatalWire(board.url)
        try:
            yield KillRig(mother, wire, board, journal)
        finally:
            mother.close()
            wire.close()


def _be_a_server(board_url: str) -> None:
    from unitylink.server.audit import Audit
    from unitylink.server.robot import Robot
    from unitylink.server.scopes import Rights
    from unitylink.server.serving import Server
    from unitylink.server.tokens import Tokens, User, digest

    tokens, audit = Tokens([(digest(TOKEN), User("all", Rights.of(["admin"])))]), Audit(lambda line: None)
    robot = Robot("arm", board_url, spec_of_rig(), tokens, audit)
    with Server([robot], tokens, audit, "127.0.0.1", 0) as server:
        robot.opened.wait()
        print(json.dumps({"pid": os.getpid(), "place": server.place}), flush=True)
        signal.pause()


def _be_the_mother() -> None:
    import unitylink.connection
    import unitylink.server.serving  # noqa: F401 - before the forks

    signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    for line in sys.stdin:
        if os.fork() == 0:
            try:
                _be_a_server(line.strip())
            finally:
                os._exit(1)


if __name__ == "__main__":
    _be_the_mother()
