# SPDX-License-Identifier: BSD-3-Clause
"""A person stops a robot, its bridge is killed and started again, and the robot stays stopped until `arm`.

The board remembers it, by its dead-man. A virtual board inside the bridge is gone with it: there, the fleet
remembers.
"""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import pytest

from unitylink import Link, connect
from unitylink.errors import AccessRefused
from unitylink.fleet.look import look_at
from unitylink.fleet.reader import read_fleet
from unitylink.layer4_data import Node
from unitylink.simulate import Board
from unitylink.spec import load
from unitylink.zenoh.link import ZenohLink

from .conftest import PATIENCE_S, UNITYLINK

TEXT = "public arm() { @goal = 0x10: i16 WRITE(SAFE=0); @angle = 0x11: i16 READ(); }\n"
GOAL = 0x10
DEAD_MAN_S = 0.2


def until(holds: Callable[[], Any]) -> Any:
    limit_s = time.monotonic() + PATIENCE_S / 2
    while not (value := holds()):
        assert time.monotonic() < limit_s, "waited in vain"
        time.sleep(0.02)
    return value


def free_router() -> str:
    with socket.create_server(("127.0.0.1", 0)) as one:
        return f"tcp/127.0.0.1:{one.getsockname()[1]}"


@contextmanager
def program(*words: object) -> Iterator[tuple[subprocess.Popen[str], Iterator[str]]]:
    """Run a command to the end of the block. Its lines are read, so it never waits for that."""
    with subprocess.Popen(
        [UNITYLINK, *map(str, words)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as running:
        watchdog = threading.Timer(PATIENCE_S, running.kill)
        watchdog.start()
        assert running.stdout is not None
        try:
            yield running, iter(running.stdout)
        finally:
            watchdog.cancel()
            running.terminate()
            running.stdout.read()


@pytest.fixture
def spec(tmp_path: Path) -> Path:
    file = tmp_path / "arm.ul"
    file.write_text(TEXT)
    return file


@pytest.fixture
def board(spec: Path) -> Iterator[Board]:
    """A board that outlives all bridges, as one of metal does."""
    with Board(load(spec), endpoint="tcp") as one:
        yield one


def robot_at(stack: ExitStack, url: str) -> tuple[Link, Node]:
    link = stack.enter_context(connect(url))
    assert isinstance(link, ZenohLink)
    return link, link.robot()


def test_in_a_fleet(board: Board, spec: Path, tmp_path: Path) -> None:
    file = tmp_path / "fleet.toml"
    file.write_text(
        f'[fleet]\nname = "lab"\nspec = "arm.ul"\nrouter = "{free_router()}"\n'
        f'[[robot]]\nname = "metal"\nlink = "{board.url}?deadman={DEAD_MAN_S}"\n'
        '[[robot]]\nname = "inside"\nlink = "sim:arm.ul"\n'
    )
    fleet = read_fleet(file)
    urls = {robot.name: fleet.url(robot) for robot in fleet.robots}

    def reports() -> list[Any]:
        return list(look_at(fleet)[1])

    with program("fleet", file) as (_, lines), ExitStack() as stack:
        assert "2 robots of lab on Zenoh" in next(lines)  # its router is there
        before = until(lambda: (told := reports()) and all(one.reachable for one in told) and told)
        for url in urls.values():
            link, robot = robot_at(stack, url)
            robot["goal"].write(50)
            link.trip()
            with pytest.raises(AccessRefused, match="zenoh has stopped the robot"):
                robot["goal"].write(51)
            link.close()
        assert board.registers[GOAL] == 0
        for one in before:
            os.kill(one.pid, signal.SIGKILL)
        until(lambda: all(one.reachable and one.restarts == 1 for one in reports()))
        assert [one.stopped_by for one in reports()] == ["zenoh", "zenoh"]
        links = [robot_at(stack, url) for url in urls.values()]
        for _, robot in links:
            with pytest.raises(AccessRefused, match=r"zenoh has stopped the robot; .*link\.arm\(\)"):
                robot["goal"].write(52)
        assert board.registers[GOAL] == 0
        for link, robot in links:
            link.arm()
            robot["goal"].write(53)
        assert board.registers[GOAL] == 53
        assert [one.stopped_by for one in reports()] == ["", ""]
        hung = next(one.pid for one in reports() if one.name == "metal")
        os.kill(hung, signal.SIGSTOP)  # the dead-man has its time again, and watches
        try:
            until(lambda: board.registers[GOAL] == 0)
        finally:
            os.kill(hung, signal.SIGKILL)


def test_without_a_fleet_the_board_alone_remembers(board: Board, spec: Path) -> None:
    router = free_router()
    words = ("bridge", "zenoh", board.url, spec, "--key", "lab/arm", "--listen", router)
    url = f"zenoh:lab/arm?connect={router}"
    with program(*words) as (running, lines), ExitStack() as stack:
        next(lines)
        link, robot = robot_at(stack, url)
        robot["goal"].write(50)
        link.trip()
        running.kill()
    with program(*words) as (_, lines), ExitStack() as stack:
        next(line for line in lines if "is lab/arm on Zenoh" in line)
        link, robot = robot_at(stack, url)
        with pytest.raises(
            AccessRefused, match=r"the board's dead-man has stopped the robot; .*link\.arm\(\)"
        ):
            robot["goal"].write(51)
        assert board.registers[GOAL] == 0
        link.arm()
        robot["goal"].write(52)
        assert board.registers[GOAL] == 52
