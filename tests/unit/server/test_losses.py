# SPDX-License-Identifier: BSD-3-Clause
"""What happens when something dies: the board, its line, a client, the server."""

from __future__ import annotations

import contextlib
import random
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.unit.server.served import Served, arm, served, token_of
from tests.unit.server.test_serving import logged_in, socket_of, until
from unitylink import Link
from unitylink.errors import LinkClosed, LinkError
from unitylink.simulate import Board


@pytest.fixture
def one() -> Iterator[Served]:
    with served() as all_of_it:
        yield all_of_it


def test_a_board_that_is_lost_and_comes_back(one: Served, tmp_path: Path) -> None:
    (tmp_path / "token").write_text("all")
    with Link(one.url(f"&reconnect=1&token_file={tmp_path}/token")) as lasting, one.link() as plain:
        positions = lasting.subscribe([0x12], divisor=10)
        assert positions.wait(5)
        one.board.hang_up()
        until(lambda: plain.closed or not quiet(plain))
        with pytest.raises(LinkClosed):
            plain.read(0x50)
        until(lambda: lasting.statistics().reconnections >= 1)
        assert lasting.wait_up(10)
        positions.drain()
        assert positions.wait(10)  # the subscription goes on
        lasting.write(0x1A, 4)
        assert one.board.registers[0x1A] == 4


def test_a_board_that_is_lost_while_nobody_is_connected(one: Served) -> None:
    """The thread of the server rests then, and the link of this program has to notice by itself."""
    with one.link() as ana:
        ana.write(0x1A, 1)
    link = one.robot.board_link()
    until(lambda: one.robot.connected == 0)
    assert link.read(0x1A) == 1
    one.board.hang_up()
    until(lambda: link.statistics().reconnections == 1)
    until(lambda: quiet(link))
    with one.link() as eva:
        eva.write(0x1A, 2)
        assert link.read(0x1A) == 2


def quiet(link: Link) -> bool:
    try:
        link.read(0x50)
    except LinkError:
        return False
    return True


def test_who_comes_while_the_board_is_away_is_told_why() -> None:
    with served(url="tcp://127.0.0.1:9?timeout=0.2") as one:
        with pytest.raises(LinkClosed, match=r"the board arm is away: .*nothing listens there"):
            one.link()
        assert one.robot.report()["away"]


def test_a_board_that_starts_after_the_server(tmp_path: Path) -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with (
        served(url=f"tcp://127.0.0.1:{port}?timeout=0.5") as one,
        Board(arm(), endpoint=f"tcp:{port}") as late,
    ):
        until(lambda: not one.robot.report()["away"])
        with one.link() as link:
            link.write(0x50, 9)
        assert late.registers[0x50] == 9


@contextlib.contextmanager
def freeze_process(one: Served, address: int) -> Iterator[subprocess.Popen[bytes]]:
    """Yield a process that has written an address and is then stopped: its connection stays open."""
    program = (
        "import sys; from unitylink import Link; link = Link(sys.argv[1])\n"
        "link.write(int(sys.argv[2]), 3); print('ready', flush=True); sys.stdin.read()"
    )
    with token_of("all"):
        arguments = [sys.executable, "-c", program, one.url(), str(address)]
        process = subprocess.Popen(arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    try:
        assert process.stdout is not None and process.stdout.readline() == b"ready\n"
        process.send_signal(signal.SIGSTOP)
        yield process
    finally:
        process.kill()
        process.communicate()


@pytest.mark.parametrize("seed", range(3))
def test_garbage_in_a_session_disturbs_nobody_else(one: Served, seed: int) -> None:
    chance = random.Random(seed)
    with one.link() as link, logged_in(one) as other:
        for _ in range(50):
            size = chance.choice([1, 7, 300, 5000])
            with contextlib.suppress(OSError):
                other.sendall(
                    bytes(chance.choice([0, 0x80, 0x82, chance.randrange(256)]) for _ in range(size))
                )
            link.write(0x50, 3)
        assert link.read(0x50) == 3
        assert one.board.registers[0x1A] == 0


@pytest.mark.takes(3)
def test_half_open_slow_and_many_logins(one: Served) -> None:
    with contextlib.ExitStack() as stack, one.link() as link:
        silent = [stack.enter_context(socket_of(one)) for _ in range(100)]
        silent[0].sendall(b"unitylink-serve 1")
        link.write(0x50, 1)
        with token_of("all"):
            late = Link(one.url("&attempts=10"))  # it waits until the silent ones are turned away
        late.close()
        silent[0].settimeout(10)
        with contextlib.suppress(ConnectionResetError):
            assert silent[0].recv(100) == b""
    until(lambda: one.server.report()["turned_away"] >= 64)


def test_a_login_storm(one: Served) -> None:
    def storm() -> None:
        while not over.is_set():
            with contextlib.suppress(OSError), socket_of(one) as caller:
                caller.sendall(b"unitylink-serve 1 arm guess\n")
                caller.recv(100)

    over = threading.Event()
    threads = [threading.Thread(target=storm) for _ in range(4)]
    with one.link() as link:
        for thread in threads:
            thread.start()
        try:
            for value in range(200):
                link.write(0x50, value)
        finally:
            over.set()
            for thread in threads:
                thread.join()
        assert one.board.registers[0x50] == 199
        assert one.server.report()["refused"] > 0
        assert len(one.lines) < 100  # a flood of refusals does not fill the log


def test_a_frame_that_is_too_long_harms_nobody(one: Served) -> None:
    with one.link() as link, logged_in(one) as other:
        for size in (5_000, 70_000, 300_000):
            with contextlib.suppress(OSError):
                other.sendall(b"\x01" * size + b"\0")  # one frame, for a zero ends it
            link.write(0x50, size % 1000)
            assert link.read(0x50) == size % 1000
        until(lambda: [client for client in one.robot.report()["clients"] if client["discarded"] >= 1])
        assert all(client["unsent"] < 64 * 1024 for client in one.robot.report()["clients"])


def test_a_session_that_is_sent_again_executes_nothing(one: Served) -> None:
    """Who has recorded the bytes of a client, with its token, comes in. They are of no session there."""
    with Recorder(one.server.place) as recorder:
        with token_of("all"), Link(f"serve://{recorder.place}/arm?timeout=2") as link:
            link.write(0x50, 11)
            link.write(0x1A, 77)
        said = recorder.said()
    assert said.startswith(b"unitylink-serve") and said.count(b"\0") >= 5  # frames
    with one.link() as link:
        link.write(0x50, 12)
        link.write(0x1A, 0)
    with logged_in(one) as thief:  # with the same token, and not faster than the client was
        thief.sendall(said.partition(b"\n")[2])
        until(lambda: any(client["discarded"] >= 2 for client in one.robot.report()["clients"]))
        with one.link("looks") as link:
            assert link.read(0x50) == 12  # neither write was executed again
    assert (one.board.registers[0x50], one.board.registers[0x1A]) == (12, 0)


class Recorder:
    """A place that forwards one connection to a server, and keeps what the client says."""

    def __init__(self, server_place: str) -> None:
        host, _, port = server_place.rpartition(":")
        self._server = socket.create_connection((host, int(port)))
        self._listener = socket.create_server(("127.0.0.1", 0))
        self.place = f"127.0.0.1:{self._listener.getsockname()[1]}"
        self._bytes = bytearray()
        self._thread = threading.Thread(target=self._forward, daemon=True)
        self._thread.start()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *_: object) -> None:
        self._listener.close()
        self._server.close()
        self._thread.join(10)

    def said(self) -> bytes:
        self._thread.join(10)  # the client has gone
        assert not self._thread.is_alive()
        return bytes(self._bytes)

    def _forward(self) -> None:
        client, _ = self._listener.accept()
        back = threading.Thread(target=_pipe, args=(self._server, client, None), daemon=True)
        back.start()
        _pipe(client, self._server, self._bytes)
        back.join(10)
        client.close()


def _pipe(source: socket.socket, sink: socket.socket, kept: bytearray | None) -> None:
    with contextlib.suppress(OSError):
        while data := source.recv(65536):
            if kept is not None:
                kept += data
            sink.sendall(data)
    with contextlib.suppress(OSError):
        sink.shutdown(socket.SHUT_WR)
