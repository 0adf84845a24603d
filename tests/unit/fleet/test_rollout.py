# SPDX-License-Identifier: BSD-3-Clause
"""An update goes from robot to robot, and stops at the first that is unwell, which gets back what it had."""

from __future__ import annotations

import itertools
import json
import os
import socket
import tempfile
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, cast

import pytest

from unitylink.errors import FleetError, LinkNotFound, UnityLinkError
from unitylink.fleet.control import Control, ask, socket_path
from unitylink.fleet.description import Fleet, FleetRobot
from unitylink.fleet.report import RobotReport
from unitylink.fleet.rollout import Rollout
from unitylink.fleet.supervisor import Supervisor

NAMES = ("arm1", "arm2", "arm3")


def robot(name: str, spec: str = "old.ul") -> FleetRobot:
    return FleetRobot(name, f"tcp://{name}:5555", spec, f"lab/{name}")


def fleet(*robots: FleetRobot) -> Fleet:
    return Fleet(Path("fleet.toml"), "lab", robots)


class Robots:
    """Takes the place of a supervisor: a robot has the hash of its spec, unless it is in `ill`."""

    def __init__(self) -> None:
        self.robots = {name: robot(name) for name in NAMES}
        self.ill: dict[str, dict[str, Any]] = {}  # by name and spec: what its report has instead
        self.leases: dict[str, str] = {}
        self.changes: list[tuple[str, str]] = []

    def differs(self, one: FleetRobot) -> bool:
        return one != self.robots[one.name]

    def wanted_hash(self, one: FleetRobot) -> str:
        return f"hash of {one.spec}"

    def change(self, one: FleetRobot) -> list[str]:
        old = [self.robots[one.name].spec]
        self.change_back(one, [one.spec])
        return old

    def change_back(self, one: FleetRobot, words: list[str]) -> None:
        assert words == [one.spec]
        self.changes.append((one.name, one.spec))
        self.robots[one.name] = one

    def reports(self) -> list[RobotReport]:
        return [self._report(one) for one in self.robots.values()]

    def _report(self, one: FleetRobot) -> RobotReport:
        told = self.wanted_hash(one)
        well = RobotReport(
            one.name,
            one.key,
            one.link,
            True,
            "up",
            hash=told,
            gateware_hash=told,
            leases=self.leases,
            restarts=0,
        )
        return replace(well, **self.ill.get(f"{one.name} {one.spec}", {}))


def rolled(robots: Robots, wanted: Fleet, *only: str, force: bool = False) -> tuple[bool, list[str]]:
    said: list[str] = []
    rollout = Rollout(
        cast("Supervisor", robots),
        lambda name, text: said.append(f"{name}: {text}"),
        settle_s=0.01,
        within_s=0.2,
    )
    return rollout.run(wanted, only, force=force), said


NEW = fleet(*(robot(name, "new.ul") for name in NAMES))


def test_all_are_updated_in_order() -> None:
    robots = Robots()
    done, said = rolled(robots, NEW)
    assert done and robots.changes == [(name, "new.ul") for name in NAMES]
    assert said[:2] == ["arm1: 1 of 3: from the spec hash of old.ul to hash of new.ul", "arm1: is well"]
    assert rolled(robots, NEW) == (True, ["lab: all robots are as the file says"])


@pytest.mark.parametrize(
    ("ill", "why"),
    [
        ({"reachable": False, "state": "board away: no port"}, "board away: no port"),
        ({"hash": "old"}, "it has the spec old"),
        ({"hash": ""}, "its bridge has not told its state"),
        ({"gateware_hash": "old"}, "its gateware was built from old"),
    ],
)
def test_it_stops_at_the_first_that_is_unwell(ill: dict[str, Any], why: str) -> None:
    robots = Robots()
    robots.ill["arm2 new.ul"] = ill
    done, said = rolled(robots, NEW)
    assert not done
    assert robots.changes == [("arm1", "new.ul"), ("arm2", "new.ul"), ("arm2", "old.ul")]
    assert said[-3:] == [
        f"arm2: is unwell, and goes back: {why}",
        "arm2: is as before",
        "lab: the update stops here; as before: arm2, arm3",
    ]


def test_a_bridge_that_ends_again_and_again_is_unwell(monkeypatch: pytest.MonkeyPatch) -> None:
    """It is on the network each time that somebody looks."""
    robots, looks, well = Robots(), itertools.count(), Robots._report

    def report(self: Robots, one: FleetRobot) -> RobotReport:
        told = well(self, one)
        ends = (one.name, one.spec) == ("arm2", "new.ul")
        return replace(told, restarts=next(looks) // 2, trouble="no port") if ends else told

    monkeypatch.setattr(Robots, "_report", report)
    done, said = rolled(robots, NEW)
    assert not done and "arm2: is unwell, and goes back: no port" in said


def test_who_is_written_is_left_alone_unless_forced() -> None:
    robots = Robots()
    robots.leases = {"j1": "ana"}
    done, said = rolled(robots, NEW)
    assert not done and not robots.changes and "is written: j1 by ana" in said[0]
    done, _ = rolled(robots, NEW, "arm3", force=True)
    assert done and robots.changes == [("arm3", "new.ul")]


def test_who_is_stopped_stays_so_unless_forced() -> None:
    robots = Robots()
    robots.ill["arm2 old.ul"] = {"stopped_by": "ana"}
    done, said = rolled(robots, NEW)
    assert not done and robots.changes == [("arm1", "new.ul")] and "arm2: is stopped by ana" in said[-2]
    done, _ = rolled(robots, NEW, "arm2", force=True)
    assert done and robots.changes[1:] == [("arm2", "new.ul")]


def test_what_needs_a_new_start_is_refused() -> None:
    with pytest.raises(FleetError, match="other robots or keys"):
        rolled(Robots(), fleet(robot("arm1")))
    with pytest.raises(FleetError, match="no robot arm9; there are arm1, arm2, arm3"):
        rolled(Robots(), NEW, "arm9")


@pytest.fixture
def runtime(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """A folder with a short name, because the path of a socket has about 100 bytes at most."""
    with tempfile.TemporaryDirectory(prefix="ul-") as folder:
        monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
        yield Path(folder)


def test_a_path_that_is_too_long_for_a_socket(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path / ("x" * 100)))
    assert socket_path(tmp_path / "fleet.toml").parent.name == f"unitylink-{os.getuid()}"
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path / ("y" * 100)))
    with pytest.raises(UnityLinkError, match="too long for a socket; set XDG_RUNTIME_DIR"):
        socket_path(tmp_path / "fleet.toml")


def test_only_the_same_user_can_ask(runtime: Path) -> None:
    file = runtime / "fleet.toml"
    with pytest.raises(LinkNotFound, match="no program of this user runs the fleet of"):
        list(ask(file, {}))

    def do(wish: dict[str, Any], say: Any) -> bool:
        if "update" not in wish:
            raise UnityLinkError("what?")
        ", ".join(wish["update"])
        say("arm1", "is well")
        return True

    control = Control(file, do)
    assert list(ask(file, {"update": []})) == [{"robot": "arm1", "text": "is well"}, {"done": True}]
    assert list(ask(file, {})) == [{"error": "what?"}]
    assert list(ask(file, {"update": 3})) == [{"error": "TypeError: can only join an iterable"}]
    for nonsense in (b"\xff\n", b"[" * 9999 + b"\n", b"3\n", b""):
        with socket.socket(socket.AF_UNIX) as talk:
            talk.connect(str(socket_path(file)))
            talk.sendall(nonsense)
            talk.shutdown(socket.SHUT_WR)
            assert talk.recv(1) == b""
    assert json.loads(json.dumps(list(ask(file, {"update": []}))))[-1] == {"done": True}
    control.close()
    assert not socket_path(file).exists()
    (runtime / "unitylink").chmod(0o755)
    with pytest.raises(UnityLinkError, match="is open to other users"):
        socket_path(file)
