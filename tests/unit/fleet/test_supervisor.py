# SPDX-License-Identifier: BSD-3-Clause
"""A fleet whose router goes away: it hears nobody, and kills no bridge for that."""

from __future__ import annotations

import contextlib
import socket
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink.fleet import bridge_process
from unitylink.fleet.reader import parse_fleet
from unitylink.fleet.supervisor import TICK_S, Supervisor
from unitylink.zenoh.session import Network


class Bridge:
    """A process that lives until it is killed or told to end."""

    lines: tuple[str, ...] = ()
    pid = 1

    def __init__(self) -> None:
        self.code: int | None = None

    def poll(self) -> int | None:
        return self.code

    def kill(self) -> None:
        self.code = -9

    def terminate(self) -> None:
        self.code = 0

    def wait(self, timeout_s: float | None = None) -> bool:
        return self.code is not None

    def close(self) -> None:
        pass


def until(holds: Callable[[], bool]) -> None:
    limit_s = time.monotonic() + 20
    while not holds():
        assert time.monotonic() < limit_s, "waited in vain"
        time.sleep(0.02)


def test_a_router_that_goes_ends_no_bridge(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bridge_process, "SILENT_S", 0.5)
    with socket.create_server(("127.0.0.1", 0)) as one:
        place = f"tcp/127.0.0.1:{one.getsockname()[1]}"
    (tmp_path / "arm.ul").write_text("public arm() { @x = 0x10: READ(); }\n")
    text = f'[fleet]\nname = "lab"\nconnect = "{place}"\n[[robot]]\nname = "a"\nlink = "sim:arm.ul"\n'
    fleet, bridges = parse_fleet(text, tmp_path / "fleet.toml"), list[Bridge]()

    def start(words: object, folder: object) -> Bridge:
        bridges.append(Bridge())
        return bridges[-1]

    with contextlib.ExitStack() as stack:
        router = Network(listen=place).opened()
        own = stack.enter_context(Network(connect=place).opened())
        supervisor = stack.enter_context(Supervisor(fleet, lambda robot, text: None, start))
        tokens = [own.liveliness().declare_token(f"lab/a/{what}/1") for what in ("bridge", "board")]
        until(lambda: supervisor.reports()[0].reachable)
        time.sleep(5 * TICK_S)  # it has seen the process on the network
        router.close()
        until(lambda: not supervisor.reports()[0].reachable)
        time.sleep(1.0)
        assert [one.code for one in bridges] == [None]
        stack.enter_context(Network(listen=place).opened())
        until(lambda: supervisor.reports()[0].reachable)
        assert [one.code for one in bridges] == [None]
        for token in tokens:
            token.undeclare()
        until(lambda: bridges[0].code == -9)
