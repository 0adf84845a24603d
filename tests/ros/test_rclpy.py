# SPDX-License-Identifier: BSD-3-Clause
"""Genuine ROS 2 (Jazzy). Colcon builds the generated package, and ROS 2 sees both nodes in Python."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

from unitylink.generate import write
from unitylink.simulate import Board
from unitylink.spec import load

HERE = Path(__file__).parent
JAZZY = HERE.parents[1] / "build" / "jazzy"
MakeBoard = Callable[..., Board]
PATIENCE_S = 120.0
STILL = """
class Plant:
    period_s = 0.01
    def attach(self, spec, registers): ...
    def step(self, time_s): ...
"""
pytestmark = pytest.mark.xdist_group("jazzy")  # one workspace is built for all of these tests


@pytest.fixture(scope="module")
def workspace(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The rig's package, built as its README says, and the environment in which its programs run."""
    assert (JAZZY / "made-of.txt").exists(), "ROS 2 is missing: tools/setup.sh ros2"
    folder = tmp_path_factory.mktemp("colcon")
    write(load(HERE / "rig.ul"), folder / "src", "ros2")
    clean = {
        k: v
        for k, v in os.environ.items()
        if not k.startswith(("ROS", "AMENT", "COLCON", "PYTHON", "CMAKE_P"))
    }
    environment = clean | {
        "PATH": f"{JAZZY / 'bin'}:{Path(sys.executable).parent}:{clean['PATH']}",
        "AMENT_PREFIX_PATH": str(JAZZY),
        "CMAKE_PREFIX_PATH": str(JAZZY),
        "ROS_LOG_DIR": str(folder / "log"),
        "PYTHONUNBUFFERED": "1",
        "MAKEFLAGS": "-j2",
    }
    python = JAZZY / "bin" / "python3"
    together = f"-DCMAKE_PROJECT_INCLUDE={HERE / 'type_support.cmake'}"
    arguments = [f"-DPython3_EXECUTABLE={python}", together]
    build = [python, "-m", "colcon", "build", "--cmake-args", *arguments]
    done = subprocess.run(
        build, cwd=folder, env=environment, capture_output=True, text=True, timeout=600, check=False
    )
    assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
    source = ["bash", "-c", ". install/setup.bash && env -0"]
    shown = subprocess.run(source, cwd=folder, env=environment, capture_output=True, check=True)
    made = dict(line.split("=", 1) for line in shown.stdout.decode().split("\0") if "=" in line)
    return made | {
        "RIG_NODE": str(folder / "install" / "rig_unitylink" / "lib" / "rig_unitylink" / "node.py")
    }


@dataclass
class Peer:
    """A process of genuine ROS 2 that takes questions in JSON."""

    process: subprocess.Popen[str]

    def __call__(self, ask: str, **more: Any) -> Any:
        assert self.process.stdin is not None and self.process.stdout is not None
        self.process.stdin.write(json.dumps({"ask": ask} | more) + "\n")
        self.process.stdin.flush()
        answer = self.process.stdout.readline()
        assert answer, "the peer has ended"
        return json.loads(answer)


def publish_until(
    device: Board, arrived: dict[int, int], peer: Peer, *commands: tuple[str, str, dict[str, Any]]
) -> None:
    """Publish until it arrives. DDS loses what is sent before the reader knows the publisher."""
    for _ in range(300):
        if {address: device.registers[address] for address in arrived} == arrived:
            return
        for topic, kind, fields in commands:
            peer("pub", topic=f"/rig/{topic}", type=kind, fields=fields)
        peer("echo", topic="/rig/joint_states", type="sensor_msgs/JointState")
    raise AssertionError("the commands have not arrived")


@contextmanager
def running(environment: dict[str, str], *command: str | Path, log: Path) -> Iterator[subprocess.Popen[str]]:
    """Start a node. At the end, interrupt it as Ctrl-C does, and check that it ends well."""
    with log.open("w") as out:
        heeding = ("env", "--default-signal=INT", *command)
        process = subprocess.Popen(heeding, env=environment, stdout=out, stderr=out, text=True)
    try:
        yield process
    finally:
        process.send_signal(signal.SIGINT)
        try:
            process.wait(timeout=PATIENCE_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        print(log.read_text())
    assert process.returncode == 0 and "Traceback" not in log.read_text(), log.read_text()


@pytest.fixture
def ros2(workspace: dict[str, str], domain: int) -> dict[str, str]:
    return workspace | {
        "ROS_DOMAIN_ID": str(domain),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "CYCLONEDDS_URI": os.environ["CYCLONEDDS_URI"],
    }


@pytest.fixture
def peer(ros2: dict[str, str]) -> Iterator[Peer]:
    command = [JAZZY / "bin" / "python3", HERE / "rclpy_peer.py"]
    with subprocess.Popen(
        command, env=ros2, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        yield Peer(process)
        process.kill()


def test_the_generated_node_on_rclpy(
    ros2: dict[str, str], peer: Peer, board: MakeBoard, tmp_path: Path
) -> None:
    device = board("rig", "still")
    for address, value in ((0x10, 500), (0x11, -100), (0x1, 0b1011), (0x3, 7)):
        device.registers[address] = value & 0xFFFF
    link = f"link:={device.url}?timeout=2"
    node = (ros2["RIG_NODE"], "--ros-args", "-r", "__ns:=/rig", "-p", link)
    with running(ros2, JAZZY / "bin" / "python3", *node, log=tmp_path / "node.log"):
        (states,) = peer("echo", topic="/rig/joint_states", type="sensor_msgs/JointState")
        assert states["name"] == ["j_0", "j_1"] and states["header"]["frame_id"] == "base"
        assert states["position"] == [0.5, 0.0] and states["velocity"] == [-1.0, 0.0]
        messages = peer("echo", topic="/rig/feedback_100hz", type="rig_unitylink/RigFeedback100Hz", count=3)
        assert [m["sequence"] - messages[0]["sequence"] for m in messages] == [0, 1, 2], "none is missing"
        assert messages[0]["flags"] == {"on": True, "heat": 2.5} and messages[0]["mode"] == 1
        (slow,) = peer("echo", topic="/rig/slow", type="std_msgs/UInt16")
        assert slow == {"data": 7}

        commands = [
            (
                *("joint_commands", "sensor_msgs/JointState"),
                {"name": ["j_1"], "position": [0.5], "velocity": [2.0]},
            ),
            ("cart/cmd_vel", "geometry_msgs/Twist", {"linear": {"x": 1.5}, "angular": {"z": -2.0}}),
            ("command", "rig_unitylink/RigCommand", {"mode": 0, "duty": [0.1, 0.2, 0.3]}),
        ]
        arrived = {0x1A: 500, 0x1B: 200, 0x8: 0x3FC00000, 0x9: 0xC0000000, 0x4: 1, 0x5: 2, 0x6: 3}
        publish_until(device, arrived, peer, *commands)

        read = peer("call", service="/rig/read", type="rig_unitylink/Read", fields={"names": ["j[0].pos"]})
        assert (read["success"], read["values"], read["texts"]) == (True, [0.5], ["0.5 rad"])
        off = peer("call", service="/rig/arm", type="std_srvs/SetBool", fields={"data": False})
        assert off["success"] and device.registers[0x1A] == 250, "disarming writes the safe values"
        wrote = {"names": ["mode"], "values": [1.0]}
        refused = peer("call", service="/rig/write", type="rig_unitylink/Write", fields=wrote)
        assert not refused["success"] and "not armed" in refused["message"]
        peer("call", service="/rig/arm", type="std_srvs/SetBool", fields={"data": True})
        safe = peer("call", service="/rig/set_safe", type="std_srvs/Trigger", fields={})
        assert safe["success"] and "j[1].pos_sp" in safe["message"]

        wrong = {"name": ["nobody"], "position": [0.5], "velocity": []}
        for _ in range(60):  # diagnostics come once a second
            # The command is alone on its topic. Of two commands in a row, a node may see only the later one.
            peer("pub", topic="/rig/joint_commands", type="sensor_msgs/JointState", fields=wrong)
            (told,) = peer("echo", topic="/diagnostics", type="diagnostic_msgs/DiagnosticArray")
            (status,) = told["status"]
            if status["level"] != [0]:
                break
        assert status["level"] == [1] and "commands refused" in status["message"]
        assert status["name"] == "/rig/unitylink: Unity-Link"
        graph = peer("graph", topic="/rig/slow")
        assert ["unitylink", "/rig"] in graph["nodes"] and graph["reliability"] == ["RELIABLE"]
        assert peer("graph", topic="/rig/j_0/feedback")["reliability"] == ["BEST_EFFORT"]
        asked = {"names": ["speed", "link"]}
        describe = ("/rig/unitylink/describe_parameters", "rcl_interfaces/DescribeParameters")
        speed, where = peer("call", service=describe[0], type=describe[1], fields=asked)["descriptors"]
        assert "time=lockstep" in speed["description"] and where["read_only"]
        assert speed["floating_point_range"] == [{"from_value": 0.0, "to_value": 1000.0, "step": 0.0}]


def test_a_board_in_steps_is_the_clock_of_ros(ros2: dict[str, str], peer: Peer, tmp_path: Path) -> None:
    """A genuine node with use_sim_time follows the board's own time, and stamps are of that time."""
    (tmp_path / "still.py").write_text(STILL)
    link = f"link:=sim:{HERE / 'rig.ul'}?plant={tmp_path / 'still.py'}&time=lockstep"
    node = (ros2["RIG_NODE"], "--ros-args", "-r", "__ns:=/rig", "-p", link, "-p", "speed:=2.0")
    with running(ros2, JAZZY / "bin" / "python3", *node, log=tmp_path / "node.log"):
        times = peer("sim_time", advance=0.5)
        assert times == sorted(times) and 0.9 < times[0] < 500, "robot time begins at 1 s"
        (states,) = peer("echo", topic="/rig/joint_states", type="sensor_msgs/JointState")
        stamp = states["header"]["stamp"]
        assert times[-1] < stamp["sec"] + stamp["nanosec"] / 1e9 < times[-1] + 500
        assert peer("graph", topic="/clock")["reliability"] == ["BEST_EFFORT"], "as ROS's own clocks"


def test_the_node_in_cpp_compiles(workspace: dict[str, str]) -> None:
    """It is compiled with the real headers of ROS 2's messages and of the rig's own.

    Only rclcpp is a stub.
    """
    install = Path(workspace["RIG_NODE"]).parents[2]
    source = install.parents[1] / "src" / "ros2" / "rig_unitylink" / "src" / "node.cpp"
    theirs = [*(JAZZY / "include").iterdir(), install / "include" / "rig_unitylink"]
    includes = [f"-I{HERE / 'stubs'}", f"-I{HERE.parents[1] / 'native' / 'include'}"]
    includes += [part for path in theirs for part in ("-isystem", str(path))]
    compiler = shutil.which("c++")
    assert compiler, "no C++ compiler: install the Debian package g++"
    command = [compiler, "-std=c++17", "-fsyntax-only", "-Wall", "-Wextra", "-Werror", *includes, str(source)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def test_the_node_on_dds_is_seen_by_ros_2(
    ros2: dict[str, str], peer: Peer, board: MakeBoard, tmp_path: Path
) -> None:
    """The node's side has no ROS 2. The other side uses DDS of another maker."""
    device = board("rig", "still")
    device.registers[0x10] = 500
    bridge = (sys.executable, "-m", "unitylink", "bridge", "ros2", f"{device.url}?timeout=2", HERE / "rig.ul")
    with running(os.environ | ros2, *bridge, log=tmp_path / "bridge.log"):
        (states,) = peer("echo", topic="/rig/joint_states", type="sensor_msgs/JointState")
        assert states["name"] == ["j_0", "j_1"] and states["position"] == [0.5, 0.0]
        graph = peer("graph", node="unitylink", namespace="/rig")
        assert graph["publishes"]["/rig/joint_states"] == ["sensor_msgs/msg/JointState"]
        assert "/rig/cart/cmd_vel" in graph["subscribes"], "it is a node with its end points"
        topics = graph["topics"]
        assert topics["/rig/joint_commands"] == ["sensor_msgs/msg/JointState"]
        assert topics["/rig/slow"] == ["std_msgs/msg/UInt16"] and topics["/rig/cart/cmd_vel"]
        fields = {"name": ["j_0"], "position": [-0.5]}
        publish_until(device, {0x12: 0xFE0C}, peer, ("joint_commands", "sensor_msgs/JointState", fields))
    assert device.registers[0x12] == 250, "safe at the end"
