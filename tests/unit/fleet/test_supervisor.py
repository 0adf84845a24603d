# SPDX-License-Identifier: BSD-3-Clause
"""A fleet whose router goes away: it hears nobody, and kills no bridge for that."""

from __future__ import annotations

import contextlib
import itertools
import socket
import time
from collections.abc import Callable
from pathlib import Path

import pytest
import zenoh

from unitylink.fleet import bridge_process
from unitylink.fleet.description import Fleet
from unitylink.fleet.reader import parse_fleet
from unitylink.fleet.supervisor import TICK_S, Supervisor
from unitylink.zenoh.session import Network


class Bridge:
    """A process that lives until it is killed or told to end."""

    lines: tuple[str, ...] = ()
    pid = 1 << 30  # there is no such process

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


def two(tmp_path: Path) -> tuple[str, Fleet]:
    """Return the place of a router that is not there yet, and a fleet of the robots a and b there."""
    with socket.create_server(("127.0.0.1", 0)) as one:
        place = f"tcp/127.0.0.1:{one.getsockname()[1]}"
    (tmp_path / "arm.ul").write_text("public arm() { @x = 0x10: READ(); }\n")
    robots = "".join(f'[[robot]]\nname = "{name}"\nlink = "sim:arm.ul"\nmay = ["read"]\n' for name in "ab")
    text = f'[fleet]\nname = "lab"\nconnect = "{place}"\n{robots}'
    return place, parse_fleet(text, tmp_path / "fleet.toml")


def until(holds: Callable[[], bool]) -> None:
    limit_s = time.monotonic() + 20
    while not holds():
        assert time.monotonic() < limit_s, "waited in vain"
        time.sleep(0.02)


@pytest.mark.takes(5)
def test_a_router_that_goes_ends_no_bridge_and_of_two_that_hang_one_is_killed_at_a_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bridge_process, "SILENT_S", 0.5)
    place, fleet = two(tmp_path)
    bridges = list[Bridge]()

    started: list[list[str]] = []

    def start(words: list[str], folder: object) -> Bridge:
        started.append(words)
        bridges.append(Bridge())
        return bridges[-1]

    def codes() -> list[int | None]:
        return sorted((one.code for one in bridges), key=str)

    with contextlib.ExitStack() as stack:
        router = Network(listen=place).opened()
        own = stack.enter_context(Network(connect=place).opened())
        supervisor = stack.enter_context(Supervisor(fleet, lambda robot, text: None, start))

        def seen(name: str) -> zenoh.LivelinessToken:
            return own.liveliness().declare_token(f"lab/{name}/bridge/1")

        def there() -> int:
            return sum(bool(supervisor._call.of(f"lab/{name}").bridges) for name in "ab")

        until(lambda: len(bridges) == 2)
        for words in started:
            options = dict(itertools.pairwise(words))
            assert options["--may"] == "read", "else it would allow what its description does not"
            assert Path(options["--stop-file"]).name == f"{options['--key'].removeprefix('lab/')}.stop"
        tokens = [seen("a"), seen("b")]
        until(lambda: there() == 2)
        time.sleep(5 * TICK_S)  # it has seen the processes on the network
        router.close()
        until(lambda: there() == 0)
        time.sleep(1.0)
        assert codes() == [None, None]
        stack.enter_context(Network(listen=place).opened())
        until(lambda: there() == 2)
        assert codes() == [None, None]
        for token in tokens:
            token.undeclare()
        until(lambda: -9 in codes())
        until(lambda: len(bridges) == 3)  # it is started again, and not there yet
        time.sleep(1.0)
        assert codes() == [-9, None, None]
        kept = seen("a" if bridges[0].code else "b")
        until(lambda: codes().count(-9) == 2)
        kept.undeclare()
