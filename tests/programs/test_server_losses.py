# SPDX-License-Identifier: BSD-3-Clause
"""A client that is stopped, and a server that is killed or ended: each is a program."""

from __future__ import annotations

import contextlib
import json
import signal
import socket
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.unit.server.served import TEXT, Served, arm, served, token_of
from tests.unit.server.test_serving import until
from unitylink import Link
from unitylink.errors import LinkClosed, LinkError, OutcomeUnknown
from unitylink.simulate import Board


@pytest.fixture
def one() -> Iterator[Served]:
    with served() as all_of_it:
        yield all_of_it


def test_a_client_that_does_not_read_is_dropped_and_slows_nobody(one: Served) -> None:
    link = one.link()
    with deaf_subscriber(one) as deaf, link:
        written, lost = 0, 0
        until(lambda: any(client["publishes"] for client in one.robot.report()["clients"]))
        while one.robot.report()["dropped_silent"] == 0:
            written += 1
            link.write(0x50, written)
            lost = max([lost, *(client["publishes_lost"] for client in one.robot.report()["clients"])])
            assert deaf.poll() is None
        assert written > 50 and lost > 0
        assert one.board.registers[0x50] == written


@contextlib.contextmanager
def deaf_subscriber(one: Served) -> Iterator[subprocess.Popen[bytes]]:
    """Yield a process that subscribes to much and is then stopped: its socket stays open, unread."""
    program = (
        "import sys; from unitylink import Link; link = Link(sys.argv[1])\n"
        "words = [0x10 + n for n in range(28)]\n"
        "groups = [link.subscribe(words, divisor=1, verify=False) for _ in range(4)]\n"
        "groups[0].wait(5); print('ready', flush=True); sys.stdin.read()"
    )
    with token_of("all"):
        arguments = [sys.executable, "-c", program, one.url()]
        process = subprocess.Popen(arguments, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    try:
        assert process.stdout is not None and process.stdout.readline() == b"ready\n"
        process.send_signal(signal.SIGSTOP)
        yield process
    finally:
        process.kill()
        process.communicate()


def test_no_old_set_point_after_a_killed_server(tmp_path: Path) -> None:
    """The whole program is killed here. test_killed.py has many points, and the board's journal."""
    spec = tmp_path / "arm.ul"
    spec.write_text(TEXT)
    with Board(arm(), endpoint="tcp") as board, started(board.url, spec) as (server, url):
        link = Link(f"{url}?timeout=1&deadman=0.1")
        written = []
        told: list[BaseException] = []

        def write() -> None:
            try:
                for value in range(1, 1_000_000):
                    written.append(value)
                    link.write(0x1A, value)
            except LinkError as error:
                told.append(error)

        writer = threading.Thread(target=write)
        writer.start()
        time.sleep(0.15)
        server.kill()
        writer.join(5)
        assert isinstance(told[0], OutcomeUnknown | LinkClosed)  # never silence
        link.close()
        until(lambda: board.registers[0x1A] == 0)  # the board's own dead-man
        with started(board.url, spec) as (_, again), Link(f"{again}?timeout=1") as fresh:
            end = time.monotonic() + 0.2
            while time.monotonic() < end:
                assert board.registers[0x1A] == 0
            fresh.arm()
            assert board.registers[0x1A] == 0
            fresh.write(0x1A, 7)
            assert board.registers[0x1A] == 7


@contextlib.contextmanager
def started(board: str, spec: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Start a server as a process, and yield it and the URL of its board. Its token is in the environment."""
    program = [sys.executable, "-m", "unitylink", "serve", board, str(spec), "--listen", "0", "--json"]
    process = subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        assert process.stdout is not None
        said = json.loads(process.stdout.readline())
        with token_of(said["token"]):
            yield process, said["urls"]["arm"]
    finally:
        process.kill()
        process.communicate()


def test_sigterm_ends_the_server_soon_and_its_outputs_are_safe(tmp_path: Path) -> None:
    spec = tmp_path / "arm.ul"
    spec.write_text(TEXT)
    with Board(arm(), endpoint="tcp") as board, started(board.url, spec) as (server, url):
        place = ("127.0.0.1", int(url.rsplit(":", 1)[1].split("/")[0]))
        with Link(f"{url}?timeout=1&deadman=5") as link, socket.create_connection(place):
            link.write(0x1A, 50)
            server.send_signal(signal.SIGTERM)
            assert server.wait(20) == 0
            assert board.registers[0x1A] == 0
            with pytest.raises(LinkError):
                link.write(0x1A, 1)
