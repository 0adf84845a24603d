# SPDX-License-Identifier: BSD-3-Clause
"""The robots of docs/robots.md: each runs, rests when its program dies, and looks as its picture says."""

from __future__ import annotations

import importlib
import json
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from unitylink import connect
from unitylink.layer4_data import Node, load_spec_objects
from unitylink.ros.mapping import plan_interface
from unitylink.simulate import Board
from unitylink.simulate.plant import load_plant
from unitylink.simulate.rtl import RtlBoard, rtl_configuration
from unitylink.spec import load

ROOT = Path(__file__).resolve().parents[2]
EXAMPLES = ROOT / "examples"
PAGE = ROOT / "docs" / "robots.md"
SILENCE_S = 0.05  # after which the dead-man trips
REST_S = 0.05  # a ramp, a period of a plant, and the writes of the dead-man
PATIENCE_S = 60.0
TRIES = 6  # a busy machine may hold up this process until the dead-man trips: a new session arms it again

pytestmark = pytest.mark.xdist_group("rtl")


class Robot(NamedTuple):
    clock_hz: int  # that the compiled VHDL needs
    topics: dict[str, str]
    start: Callable[[Node], None]  # lets it move for as long as nobody stops it
    moved: Callable[[Board], float]  # a number that stays the same when its outputs are safe


def moves(robot: Robot, board: Board, before: float) -> bool:
    end = time.monotonic() + PATIENCE_S / TRIES
    while robot.moved(board) == before and time.monotonic() < end:
        time.sleep(0.002)
    return robot.moved(board) != before


def until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + PATIENCE_S
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def start_stage(board: Node) -> None:
    item: Any = board
    item["motor.speed[0]"].write(100.0)
    item["motor.acceleration[0]"].write(4000.0)
    item["motor.velocity_target[0]"].write(40.0)
    fields = {"enable": True, "velocity_mode": True, "stop_at_limit": True, "latch": "none"}
    item["motor.control[0]"].write(fields)


def start_arm(board: Node) -> None:
    item: Any = board
    item["arm.speed[0]"].write(100.0)
    item["arm.acceleration[0]"].write(4000.0)
    item["arm.velocity_target[0]"].write(40.0)
    fields = {"enable": True, "velocity_mode": True, "stop_at_limit": False, "latch": "none"}
    item["arm.control[0]"].write(fields)


def start_cart(board: Node) -> None:
    item: Any = board
    item["left_motor.duty"].write(0.3)
    item["left_motor.control"].write({"enable": True, "coast": True})


def start_bus_arm(board: Node) -> None:
    item: Any = board
    until(lambda: item["arm.status[6]"].read().valid)
    item["arm.goal[0]"].write(0.5)
    item["arm.drive[0]"].write("follow")


def start_joint(board: Node) -> None:
    item: Any = board
    for part in ("stop", "current"):
        item[f"{part}.control"].write({"enable": True})
    item["loop.kp"].write(0.3)
    item["loop.apply"].pulse()
    item["loop.target_q"].write(6.0)
    item["loop.control"].write({"enable": True, "align": True})
    item["motor.control"].write({"enable": True, "sample_start": False, "sample_middle": False})


def pulses(board: Board) -> float:
    """Return the pulses of a motor. A pin that stays low has none."""
    bridge = board.components["left_motor"]
    return float(sum(bridge.rises("pins", pin) for pin in range(4)))


ROBOTS = {
    "bus_arm": Robot(
        8_000_000,
        {"joint_states": "sensor_msgs/JointState", "joint_commands": "sensor_msgs/JointState"},
        start_bus_arm,
        lambda board: sum(board.components["arm"].servo(number).goal for number in range(7)),
    ),
    "diff_drive": Robot(
        1_000_000,
        {
            "joint_states": "sensor_msgs/JointState",
            "imu/imu": "sensor_msgs/Imu",
            "battery/battery": "sensor_msgs/BatteryState",
            "odom": "nav_msgs/Odometry",
        },
        start_cart,
        pulses,
    ),
    "foc_joint": Robot(
        8_000_000,
        {"joint_states": "sensor_msgs/JointState", "joint_commands": "sensor_msgs/JointState"},
        start_joint,
        lambda board: float(sum(board.components["motor"].rises("high", phase) for phase in range(3))),
    ),
    "scara_stepper": Robot(
        18_000_000,
        {"joint_states": "sensor_msgs/JointState", "joint_commands": "sensor_msgs/JointState"},
        start_arm,
        lambda board: board.components["arm"].steps("step", "direction", 0),
    ),
    "xyz_stage": Robot(
        18_000_000,
        {"joint_states": "sensor_msgs/JointState", "joint_commands": "sensor_msgs/JointState"},
        start_stage,
        lambda board: board.components["motor"].steps("step", "direction", 0),
    ),
}


def board_of(name: str, kind: type[Board]) -> Board:
    spec = load(EXAMPLES / name / f"{name}.ul")
    plant = load_plant(str(EXAMPLES / name / "plant.py"), spec)
    if kind is RtlBoard:
        configuration = rtl_configuration(spec, clock_hz=ROBOTS[name].clock_hz)
        return RtlBoard(spec, plant=plant, endpoint="tcp", configuration=configuration)
    return Board(spec, plant=plant, endpoint="tcp")


def rests(board: Board, name: str) -> None:
    """Its outputs are safe within the time of the dead-man and a ramp, and stay so."""
    due_s = board.time_s + SILENCE_S + REST_S
    until(lambda: board.time_s > due_s)
    before = ROBOTS[name].moved(board)
    until(lambda: board.time_s > due_s + 0.05)
    assert ROBOTS[name].moved(board) == before
    assert board.error is None


KINDS = [(name, kind) for name in ROBOTS for kind in (Board, RtlBoard)]
# the stage has the same component
LONG = ("scara_stepper", RtlBoard)


@pytest.mark.parametrize(
    ("name", "kind"), [pytest.param(*one, marks=pytest.mark.long) if one == LONG else one for one in KINDS]
)
def test_a_robot_rests_when_its_line_is_cut(name: str, kind: type[Board]) -> None:
    robot, spec = ROBOTS[name], load(EXAMPLES / name / f"{name}.ul")
    with board_of(name, kind) as board:
        for _ in range(TRIES):
            with connect(f"{board.url}?protocol=framed&timeout=2&deadman={SILENCE_S}") as link:
                robot.start(load_spec_objects(spec, link))
                before = robot.moved(board)
                if moves(robot, board, before):
                    board.hang_up()
                    rests(board, name)
                    return
        pytest.fail("the robot never moved")


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_rests_when_its_program_is_killed(name: str) -> None:
    command = [sys.executable, str(EXAMPLES / name / "run.py"), "--link"]
    with board_of(name, Board) as board:
        before = ROBOTS[name].moved(board)
        with subprocess.Popen(
            [*command, f"{board.url}?deadman={SILENCE_S}"], stdout=subprocess.DEVNULL
        ) as run:
            until(lambda: ROBOTS[name].moved(board) != before)
            run.send_signal(signal.SIGKILL)
        rests(board, name)


@pytest.mark.parametrize("name", ROBOTS)
def test_a_robot_has_the_topics_of_its_kind(name: str) -> None:
    spec = EXAMPLES / name / f"{name}.ul"
    assert len(spec.read_text("utf-8").splitlines()) <= 40
    interface = plan_interface(load(spec))
    types = {topic.name: topic.type for topic in (*interface.published, *interface.commanded)}
    assert types.items() >= ROBOTS[name].topics.items()


@pytest.mark.long
@pytest.mark.parametrize("name", json.loads((ROOT / "gateware" / "bitstreams.json").read_text("utf-8")))
def test_a_bitstream_takes_what_the_record_tells(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools" / "synth"))
    tool = importlib.import_module("bitstreams")
    command = next(one for one in tool.commands(PAGE.read_text("utf-8")) if one.name == name)
    row, told = tool.built(command), json.loads(tool.RECORD.read_text("utf-8"))[name]
    assert tool.complaints({name: row}) == []
    for what, most in (("cells", 0.03), ("memories", 0.0)):  # versions of yosys differ
        (used, available), recorded = row[what], told[what]
        assert available == recorded[1] and abs(used / recorded[0] - 1) <= most
    assert abs(row["mhz"] / told["mhz"] - 1) < 0.15
