# SPDX-License-Identifier: BSD-3-Clause
"""The generated package for LeRobot: it is found, has the published interface, and works on boards."""

from __future__ import annotations

import logging
import runpy
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from unit.lerobot.arm import SPEC, write_arm
from unit.lerobot.published import ROBOT, TELEOPERATOR, device_of, plug_ins, shape_of, stand_in

from unitylink.errors import BindingError, UnityLinkError, ValueRangeError
from unitylink.generate import generate, write
from unitylink.lerobot import Leader
from unitylink.spec import compile_text, load

HOLD = {"speed_limit": 3.0, "grip": 0.5}


def said_by(script: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Any]:
    """Return what a setup.py gives to setuptools, which installs it in `make lerobot`."""
    told: dict[str, Any] = {}
    tools = ModuleType("setuptools")
    tools.setup = lambda **given: told.update(given)  # type: ignore[attr-defined]
    monkeypatch.setitem(sys.modules, "setuptools", tools)
    runpy.run_path(str(script))
    return told


@pytest.fixture
def registries(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[tuple[Any, Any]]:
    """The package as it is installed: its folder, and what pip writes beside it."""
    write_arm(tmp_path)
    write(load(tmp_path / "small_arm.ul"), tmp_path, "lerobot")
    folder = tmp_path / "lerobot" / "lerobot_robot_small_arm"
    told = said_by(folder / "setup.py", monkeypatch)
    assert told["packages"] == [told["name"]] and (folder / told["name"]).is_dir()
    metadata = folder / f"{told['name']}-{told['version']}.dist-info" / "METADATA"
    metadata.parent.mkdir()
    metadata.write_text(f"Metadata-Version: 2.1\nName: {told['name']}\nVersion: {told['version']}\n")
    monkeypatch.syspath_prepend(folder)
    with stand_in(monkeypatch) as made:
        try:
            assert "lerobot_robot_small_arm" in plug_ins()
            yield made[0].known, made[1].known
        finally:
            for name in [one for one in sys.modules if one.startswith("lerobot_robot_")]:
                del sys.modules[name]


def test_lerobot_finds_robot_and_leader(registries: tuple[Any, Any], tmp_path: Path) -> None:
    robots, leaders = registries
    assert list(robots) == ["small_arm"] and list(leaders) == ["small_arm_leader"]
    robot = device_of(robots["small_arm"](link=write_arm(tmp_path)))
    leader = device_of(leaders["small_arm_leader"](link=write_arm(tmp_path), hold=HOLD))
    for device, table in ((robot, ROBOT), (leader, TELEOPERATOR)):
        base = type(device).__mro__[1]
        assert base.__abstractmethods__ == set(table)
        for member, told in table.items():
            assert shape_of(type(device), member) == told == shape_of(base, member), member
        assert device.name in (*robots, *leaders) and device.config_class is type(device.config)
        assert not device.is_connected and device.is_calibrated
    assert robot.cameras == {} and leader.feedback_features == {}
    assert set(robot.observation_features.values()) | set(robot.action_features.values()) == {float}
    assert list(robot.action_features) == list(leader.action_features)
    assert "mode" not in robot.observation_features, "an enumeration is no number"


def test_the_robot_follows_the_leader(registries: tuple[Any, Any], tmp_path: Path) -> None:
    robots, leaders = registries
    robot = device_of(robots["small_arm"](link=write_arm(tmp_path), id="follower"))
    leader = device_of(leaders["small_arm_leader"](link=write_arm(tmp_path), hold=HOLD))
    robot.connect()
    leader.connect(calibrate=False)
    try:
        with pytest.raises(UnityLinkError, match="connected already"):
            robot.connect()
        moved = leader._leader._side._link.board.registers
        moved[0x12], moved[0x1A] = 300, -200  # a person moves the leader's joints
        until_s = time.monotonic() + 20  # both joints need 0.3 s, twice
        while time.monotonic() < until_s:
            sent = robot.send_action(leader.get_action())
            seen = robot.get_observation()
            assert sent["speed_limit"] == 3.0 and sent["grip"] == 0.5
            if (seen["j[0].position"], seen["j[1].position"]) == (0.3, -0.2):
                break
        assert (seen["j[0].position"], seen["j[1].position"]) == (0.3, -0.2)
        assert set(seen) == set(robot.observation_features) and seen["fault"] == 0.0
        board = robot._follower._link.board.registers
        assert board[0x12] == 300 and board[0x30] == 3000
        assert robot._follower._link.dead_man().tripped is False
    finally:
        leader.disconnect()
        robot.disconnect()
    robot.disconnect()
    for use in (robot.get_observation, lambda: robot.send_action(sent), leader.get_action):
        with pytest.raises(UnityLinkError, match="not connected"):
            use()


def test_actions_beyond_a_limit_and_wrong_ones(registries: tuple[Any, Any], tmp_path: Path) -> None:
    robot = device_of(registries[0]["small_arm"](link=write_arm(tmp_path), deadman_s=0.0))
    robot.connect()
    try:
        action = {"j[0].target": 0.0, "j[1].target": 0.0, "speed_limit": 1.0, "grip": 7.0}
        assert robot.send_action(action)["grip"] == 5.0 and robot._follower.clipped == 1
        for wrong, says in (
            (action | {"j[0].target": 3.0}, r"j\[0\].target: the action 3 is not in -2 to 2 rad"),
            ({"grip": 1.0}, r"without j\[0\].target, j\[1\].target, speed_limit"),
            (action | {"knee": 1.0}, "with knee that the robot lacks"),
            (action | {"grip": float("nan")}, "not a number"),
        ):
            with pytest.raises(ValueRangeError, match=says):
                robot.send_action(wrong)
        board = robot._follower._link.board.registers
        assert board[0x31] == 500, "nothing of them was written"
    finally:
        robot.disconnect()


def test_a_board_without_a_dead_man_says_so(
    registries: tuple[Any, Any], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    link = f"{write_arm(tmp_path)}&protocol=classic"
    robot = device_of(registries[0]["small_arm"](link=link))
    with caplog.at_level(logging.WARNING):
        robot.connect()
    robot.disconnect()
    assert "without a dead-man, its outputs stay at the end" in caplog.text


def test_a_leader_says_what_is_open() -> None:
    commanded = ("a", "b")
    with pytest.raises(UnityLinkError, match=r"what b gets: name .* in `follow`, or a number in `hold`"):
        Leader("sim:", lambda link: None, commanded, {"a": "x"}, {})  # type: ignore[arg-type, return-value]
    with pytest.raises(UnityLinkError, match="c is no action of the follower; there are a, b"):
        Leader("sim:", lambda link: None, commanded, {"a": "x"}, {"b": 1.0, "c": 2.0})  # type: ignore[arg-type, return-value]


def test_a_robot_without_two_sides_is_refused() -> None:
    spec = compile_text("public lamp() { @led = 0x10: WRITE(); }", "lamp.ul").spec
    assert spec is not None
    with pytest.raises(BindingError, match=r"no number of lamp can be observed \(a READ\)"):
        generate(spec, "lerobot")


def test_the_package_is_the_same_each_time() -> None:
    spec = compile_text(SPEC, "small_arm.ul").spec
    assert spec is not None
    assert generate(spec, "lerobot") == generate(spec, "lerobot")
