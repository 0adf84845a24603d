# SPDX-License-Identifier: BSD-3-Clause
"""A fleet of eight on a router of its own: one bridge is killed and comes back, and all end in order.

The programs of docs/zenoh.md run on it, and the page of fleets by itself.
"""

from __future__ import annotations

import json
import os
import re
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from unittest.mock import MagicMock

import pytest

from unitylink import connect
from unitylink.cli import main
from unitylink.errors import FleetError
from unitylink.fleet.look import look_at
from unitylink.fleet.reader import parse_fleet, read_fleet
from unitylink.fleet.robots import Robots
from unitylink.layer4_data import WriteValue
from unitylink.recording.formats import samples
from unitylink.zenoh.link import ZenohLink
from unitylink.zenoh.session import ROUTER

from .conftest import PATIENCE_S, ROOT, SCARA, UNITYLINK
from .test_tutorials import script_of

COUNT = 8


@pytest.fixture
def router() -> str:
    with socket.create_server(("127.0.0.1", 0)) as one:
        return f"tcp/127.0.0.1:{one.getsockname()[1]}"


@pytest.fixture
def file(tmp_path: Path, router: str) -> Path:
    robots = "".join(f'[[robot]]\nname = "arm{n}"\nlink = "sim:{SCARA}"\n' for n in range(1, COUNT + 1))
    path = tmp_path / "fleet.toml"
    path.write_text(f'[fleet]\nname = "lab"\nrouter = "{router}"\n{robots}')
    return path


def blocks_for_python(page: str, router: str) -> list[str]:
    """Return the Python of a page, with another router."""
    found = re.findall(r"^```python\n(.*?)^```", (ROOT / "docs" / page).read_text("utf-8"), re.M | re.S)
    return [
        one.replace("zenoh:lab/arm1", f"zenoh:lab/arm1?connect={router}").replace(ROUTER, router)
        for one in found
    ]


def until(lines: Iterator[str], *wanted: str) -> None:
    """Read lines until each wanted one has come, in any order."""
    waiting = set(wanted)
    while waiting:
        line = next(lines)
        waiting -= {one for one in waiting if re.search(one, line)}


def stream_set_points(block: str, url: str) -> None:
    """Run the block of a page that streams set-points while `running`, until the robot has executed one."""
    limit_s = time.monotonic() + PATIENCE_S / 2
    with connect(url) as link:
        assert isinstance(link, ZenohLink)

        def written() -> int:
            return int(link.state()["set_points"]["written"])

        before = written()
        running = MagicMock(
            **{"__bool__.side_effect": lambda: written() == before and time.monotonic() < limit_s}
        )
        exec(block, {"link": link, "running": running})
        assert written() > before, link.state()


def write_together(file: Path) -> None:
    """Run the block of the page of fleets that writes several robots together."""
    (block,) = blocks_for_python("fleet.md", "")
    block = block.replace('"fleet.toml"', repr(str(file)), 1)
    exec(block.replace("x.position", "j1.cpos").replace("x.target", "j1.pos_sp"), {})
    with Robots(file, "arm1", "arm2", "arm3") as robots:
        for name, written in (("arm1", 200), ("arm2", 300), ("arm3", 100)):
            value = robots[name]["j1.pos_sp"]
            assert isinstance(value, WriteValue)
            assert value.hardware.link.read(value.addresses[0]) == written
        assert set(robots.group("j1.cpos").snapshot()) == set(robots)
    with pytest.raises(FleetError, match="no robot arm9; there are arm1, "):
        Robots(file, "arm9")


def test_one_is_killed_and_comes_back(file: Path, router: str, capsys: pytest.CaptureFixture[str]) -> None:
    fleet = read_fleet(file)
    with subprocess.Popen(
        [UNITYLINK, "fleet", file], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
    ) as running:
        watchdog = threading.Timer(PATIENCE_S, running.kill)  # its bridges end with it
        watchdog.start()
        assert running.stdout is not None
        lines = iter(running.stdout)
        try:
            until(lines, *(rf"arm{n}: up" for n in range(1, COUNT + 1)), "^arm8 +up ")
            told, before = look_at(fleet)
            assert told and all(one.reachable and one.restarts == 0 for one in before)
            assert len({one.pid for one in before}) == COUNT and len({one.hash for one in before}) == 1
            assert all(one.gateware_hash == one.hash for one in before)
            killed = before[2].pid
            assert killed is not None
            os.kill(killed, signal.SIGKILL)
            until(
                lines, "arm3: gone from the network", r"arm3: ended with signal 9; .* 0\.25 s \(restart 1\)"
            )
            until(lines, "arm3: up")
            _, after = look_at(fleet)
            assert [one.restarts for one in after] == [0, 0, 1, 0, 0, 0, 0, 0]
            same = [one.pid == other.pid for one, other in zip(before, after, strict=True)]
            assert same == [True, True, False, True, True, True, True, True]
            assert main(["fleet", "check", str(file)]) == 0
            assert "8 of 8 robots are up; specs: 1; gateware built from: 1" in capsys.readouterr().out
            first, set_points, stranger = blocks_for_python("zenoh.md", router)
            exec(first, {})
            exec(stranger, {})
            assert re.fullmatch(r"-?\d+\n\(-?\d+,\)\n", capsys.readouterr().out)
            stream_set_points(set_points, f"zenoh:lab/arm1?connect={router}")
            write_together(file)
            assert main(["fleet", str(file)]) == 1
            assert "another program runs the fleet lab on this network" in capsys.readouterr().err
            recording = str(file.with_name("lab.mcap"))
            assert main(["fleet", "record", str(file), "--out", recording, "--duration", "1", "--json"]) == 0
            told_of = json.loads(capsys.readouterr().out)
            assert told_of["lost"] == 0 and min(told_of["robots"].values()) > 20
            times = [sample.time_s for sample in samples(recording)]
            assert times == sorted(times) and abs(times[-1] - time.time()) < 10
            running.send_signal(signal.SIGTERM)
            rest = "".join(lines)
        finally:
            watchdog.cancel()
            running.terminate()
    assert running.returncode == 0, rest
    for one in after:
        assert one.pid is not None
        with pytest.raises(ProcessLookupError):
            os.kill(one.pid, 0)


def test_the_fleet_of_the_page_can_be_read(tmp_path: Path) -> None:
    (tmp_path / "arm.ul").write_text("public arm() { @x = 0x10: READ(); }\n")
    page = (ROOT / "docs" / "fleet.md").read_text("utf-8")
    blocks = re.findall(r"^```toml[^\n]*\n(.*?)^```", page, re.M | re.S)
    fleets = [parse_fleet(block, tmp_path / "fleet.toml") for block in blocks]
    assert [len(fleet.robots) for fleet in fleets] == [2, 1]


@pytest.mark.long
def test_the_page_works_as_it_stands(router: str, tmp_path: Path) -> None:
    script = script_of("fleet.md").replace("[fleet]\n", f'[fleet]\nrouter = "{router}"\n', 1)
    script = script.replace("zenoh:lab/arm2", f'"zenoh:lab/arm2?connect={router}"')
    path = f"{UNITYLINK.parent}:{os.environ['PATH']}"
    done = subprocess.run(
        ["bash", "-c", script],
        cwd=tmp_path,
        env={**os.environ, "PATH": path},
        capture_output=True,
        text=True,
        timeout=PATIENCE_S,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    assert "2 of 2 robots are up; specs: 1; gateware built from: 1" in done.stdout
    assert "x.position = " in done.stdout
