# SPDX-License-Identifier: BSD-3-Clause
"""The generated catkin packages with rosmaster, roslaunch, rostopic, rosservice and rosbag."""

from __future__ import annotations

import re
import shlex
import subprocess
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from unitylink.simulate import Board

Ros = Any  # of conftest.py

MakeBoard = Callable[..., Board]
ROOT = Path(__file__).parents[2]
SPECS = {"walker18": ROOT / "examples" / "walker18" / "walker18_si.ul"}
NODES = ["node.py", "node"]
pytestmark = pytest.mark.xdist_group("ros1")  # one workspace is built for all of these tests


def launch(ros: Ros, robot: str, url: str, node: str) -> subprocess.Popen[str]:
    # a busy machine may keep the node from showing life for a second, and what was commanded is dropped then
    command = (
        "roslaunch",
        f"{robot}_unitylink",
        f"{robot}.launch",
        f"link:={url}?timeout=2&deadman=30",
        f"node:={node}",
    )
    return ros.start(*command)


def echo(ros: Ros, topic: str, count: int = 1) -> str:
    return ros.run("rostopic", "echo", "-n", str(count), topic)


@pytest.mark.parametrize("node", NODES)
def test_scara_moves_by_rostopic_pub(ros: Ros, board: MakeBoard, node: str) -> None:
    """As in the paper: topics come by themselves, and a published set-point moves the joint."""
    device = board("scara", "scara")
    launch(ros, "scara", device.url, node)
    shown = echo(ros, "/scara/j1/feedback", 3)
    assert re.findall(r"^cpos: (\S+)", shown, re.M) == ["0", "0", "0"]
    numbers = [int(number) for number in re.findall(r"^sequence: (\d+)", shown, re.M)]
    assert numbers == list(range(numbers[0], numbers[0] + 3)), "no publish is missing"
    assert not re.search(r"secs: 0$", shown, re.M), "stamped"
    ros.publish("/scara/j1/command", "scara_unitylink/JointCommand", "{pos_sp: 3000, spd_sp: 30000}")
    ros.until(lambda: device.registers.signed(0x80 + 8) > 2900)  # cpos
    ros.publish("/scara/j2/pos_sp", "std_msgs/Int32", "{data: -500}")
    ros.until(lambda: device.registers.signed(0x8D) == -500)
    assert "values: [3000.0]" in ros.run("rosservice", "call", "/scara/read", "names: [j1.cpos]")
    assert "success: True" in ros.run(
        "rosservice", "call", "/scara/write", "{names: [j3.pos_sp], values: [77]}"
    )
    assert device.registers[0x8E] == 77
    refused = ros.run("rosservice", "call", "/scara/write", "{names: [j3.pos], values: [77]}")
    assert "success: False" in refused and "j3.pos" in refused


def test_a_board_in_steps_is_the_clock_of_ros(ros: Ros) -> None:
    """With use_sim_time, genuine tools count the board's own time."""
    ros.run("rosparam", "set", "/use_sim_time", "true")
    spec = ROOT / "examples" / "scara" / "scara.ul"
    url = f"sim:{spec}?plant=scara&time=lockstep"
    ros.start("roslaunch", "scara_unitylink", "scara.launch", f"link:={url}")
    clocks = re.findall(r"nsecs: *(\d+)", echo(ros, "/clock", 3))
    steps = [(int(later) - int(earlier)) % 10**9 for earlier, later in pairwise(clocks)]
    assert all(step > 100 and (step + 100) % 10_000_000 < 200 for step in steps), clocks
    stamped = re.search(r" secs: *(\d+)", echo(ros, "/scara/j1/feedback"))
    assert stamped and 0 < int(stamped[1]) < 10_000, "the stamp is of robot time, which begins at 1 s"
    asked = "import rospy; rospy.init_node('asks'); rospy.sleep(0.2); print(rospy.get_time())"
    assert 1.0 < float(ros.run("python3", "-c", asked)) < 10_000


@pytest.mark.parametrize("node", NODES)
def test_every_form_arrives_both_ways(ros: Ros, board: MakeBoard, node: str) -> None:
    device = board("rig", "still")
    for address, value in ((0x10, 500), (0x11, -100), (0x1, 0b1011), (0x3, 7)):
        device.registers[address] = value & 0xFFFF
    launch(ros, "rig", device.url, node)
    states = echo(ros, "/rig/joint_states")
    assert re.search(r"^name:\s+- j_0\n\s+- j_1\nposition:", states, re.M), states
    assert "position: [0.5, 0.0]" in states and "velocity: [-1.0, 0.0]" in states
    assert 'frame_id: "base"' in states or "frame_id: 'base'" in states
    whole = echo(ros, "/rig/feedback_100hz")
    assert "mode: 1" in whole and "on: True" in whole and "heat: 2.5" in whole
    assert "data: 7" in echo(ros, "/rig/slow")
    for topic, kind, text in (
        ("cart/cmd_vel", "geometry_msgs/Twist", "{linear: {x: 1.5}, angular: {z: -2.0}}"),
        ("joint_commands", "sensor_msgs/JointState", "{name: [j_1], position: [0.5], velocity: [2.0]}"),
        ("command", "rig_unitylink/RigCommand", "{mode: 0, duty: [0.1, 0.2, 0.3]}"),
    ):
        ros.publish(f"/rig/{topic}", kind, text)
    ros.until(lambda: (device.registers[0x8], device.registers[0x9]) == (0x3FC00000, 0xC0000000))
    ros.until(lambda: (device.registers[0x1A], device.registers[0x1B]) == (500, 200))
    ros.until(lambda: [device.registers[0x4 + i] for i in range(3)] == [1, 2, 3] and not device.registers[0])
    assert "success: True" in ros.run("rosservice", "call", "/rig/arm", "data: false")
    assert device.registers[0x1A] == 250, "disarming writes the safe values"
    ros.publish("/rig/j_1/pos_sp", "std_msgs/Float64", "0.5")
    ros.until(lambda: "commands refused" in echo(ros, "/diagnostics"))
    refused = ros.run("rosservice", "call", "/rig/write", "{names: [mode], values: [1]}")
    assert "not armed" in refused and device.registers[0x1A] == 250
    assert "success: True" in ros.run("rosservice", "call", "/rig/arm", "data: true")
    assert "success: True" in ros.run("rosservice", "call", "/rig/set_safe")


@pytest.mark.parametrize("node", NODES)
def test_node_waits_for_the_device_and_survives_its_loss(ros: Ros, board: MakeBoard, node: str) -> None:
    first = board("rig", "still")
    url, port = first.url, first.url.rpartition(":")[2]
    first.close()
    launch(ros, "rig", url, node)
    assert "waiting for the device" in echo(ros, "/diagnostics")
    second = board("rig", "still", f"tcp:{port}")
    echo(ros, "/rig/joint_states")
    second.close()
    lost = echo(ros, "/diagnostics", 2)
    assert "level: 2" in lost
    third = board("rig", "still", f"tcp:{port}")
    third.registers[0x12] = 999
    echo(ros, "/rig/joint_states")
    assert third.registers[0x12] == 250, "safe before the first publish"


@pytest.mark.parametrize("node", NODES)
def test_a_killed_node_leaves_the_outputs_safe(ros: Ros, board: MakeBoard, node: str) -> None:
    """The gateware does this by itself. The next node arms it again."""
    device = board("rig", "still")
    program = str(Path(ros.environment["CMAKE_PREFIX_PATH"].split(":")[0]) / "lib" / "rig_unitylink" / node)
    command = (program, "__ns:=/rig", f"_link:={device.url}?timeout=2&deadman=0.5")
    process = ros.start(*command)
    echo(ros, "/rig/joint_states")
    ros.publish("/rig/j_0/pos_sp", "std_msgs/Float64", "0.5")
    ros.until(lambda: device.registers[0x12] == 500)
    process.kill()
    ros.until(lambda: device.registers[0x12] == 250)
    ros.start(*command)
    echo(ros, "/rig/joint_states")
    ros.publish("/rig/j_0/pos_sp", "std_msgs/Float64", "0.5")
    ros.until(lambda: device.registers[0x12] == 500)
    told = echo(ros, "/diagnostics", 2)
    assert "trips after 0.5 s" in told and re.search(r'device deadman trips"\s+value: "[1-9]', told), told


def test_wrong_commands_are_refused_by_the_node_in_cpp(ros: Ros, board: MakeBoard) -> None:
    device = board("rig", "still")
    launch(ros, "rig", device.url, "node")
    echo(ros, "/rig/joint_states")
    for names, values, says in (
        ("[mode]", "[2]", "out of its limits"),
        ("['j[0].pos_sp', mode]", "[0.5, 7]", "out of its limits"),
        ("[nope]", "[1]", "no value is called"),
        ("[flags]", "[1]", "cannot be written"),
        ("[mode]", "[]", "as many names"),
    ):
        answer = ros.run("rosservice", "call", "/rig/write", f"{{names: {names}, values: {values}}}")
        assert "success: False" in answer and says in answer
    assert device.registers[0x12] == 0, "nothing of a refused command is written"
    workspace = Path(ros.environment["CMAKE_PREFIX_PATH"].split(":")[0])
    program = workspace / "lib" / "rig_unitylink" / "node"
    other = ros.start(str(program), "__name:=other", "_link:=sim:rig.ul?time=lockstep")
    assert other.wait(timeout=60) == 1
    assert "it publishes /clock (node:=node.py); this one cannot" in (ros.folder / "node.log").read_text()


def test_the_tutorial_does_what_it_says(ros: Ros, board: MakeBoard) -> None:
    """docs/ros.md, command by command. Its installation and its build are the workspace of these tests."""
    text = (Path(__file__).parents[2] / "docs" / "ros.md").read_text()
    section = text[text.index("## ROS 1, in ten minutes") : text.index("## ROS 2,")]
    _, build, terminals, commands = re.findall(r"```sh\n(.*?)```", section, re.S)
    assert build.startswith(
        "unitylink generate examples/scara/scara.ul --out ws/src --only ros1\ncd ws && catkin_"
    )
    device = board("scara", "scara")
    master, simulate, roslaunch = terminals.splitlines()
    assert (master, simulate) == (
        "roscore",
        "unitylink simulate examples/scara/scara.ul --plant scara --tcp 5555",
    )
    ros.start(*shlex.split(roslaunch.replace("tcp://127.0.0.1:5555", f"{device.url}?timeout=2")))
    echo(ros, "/scara/j1/feedback")
    active = ros.folder / "run.bag.active"  # the file while rosbag writes it
    for command in commands.splitlines():
        words = shlex.split(command)
        if words[:2] in (["rostopic", "hz"], ["rostopic", "echo"], ["rosbag", "record"]):  # until Ctrl-C
            log = ros.folder / f"{words[0]}.log"
            shown = {"hz": "average rate", "echo": "cpos:"}.get(words[1])
            process = ros.start(*words)
            ros.until(lambda log=log, shown=shown: shown in log.read_text() if shown else active.exists())
            ros.interrupt(process)
        else:
            said = ros.run(*words)
            if words[0] == "rosservice":
                assert "success: True" in said, said
            if words[:2] == ["rostopic", "list"]:
                assert "/scara/j1/feedback\n" in said and "/scara/j2/pos_sp\n" in said
    assert device.registers.signed(0x80 + 8) > 2900 and device.registers.signed(0x8D) == -500
    ros.until((ros.folder / "run.bag").exists)


@pytest.mark.long
@pytest.mark.parametrize("node", NODES)
def test_the_walker_needs_nothing_by_hand(ros: Ros, board: MakeBoard, node: str) -> None:
    """18 joints both ways, with a package that is built and launched exactly as it was generated."""
    device = board("walker18", "still")
    device.registers[0x40] = -250 & 0xFFFF
    launch(ros, "walker18", device.url, node)
    states = echo(ros, "/walker18/joint_states")
    assert len(re.findall(r"^ *- leg_\d_(hip|knee|foot)$", states, re.M)) == 18, states
    assert "position: [-0.25, 0.0," in states
    ros.publish("/walker18/joint_commands", "sensor_msgs/JointState", "{name: [leg_5_foot], position: [0.5]}")
    ros.until(lambda: device.registers[0x186] == 500)
    ros.publish("/walker18/leg_0/command", "walker18_unitylink/LegCommand", "{hip_sp: 0.1, knee_sp: -0.2}")
    ros.until(lambda: [device.registers[0x44], device.registers[0x45]] == [100, -200 & 0xFFFF])


def test_bridge_and_rosbag(ros: Ros, board: MakeBoard) -> None:
    """The walker's 18 joints with nothing generated. rosbag records them, rosbags reads them without ROS."""
    from rosbags.highlevel import AnyReader

    device = board("walker18", "ramp")
    ros.start(
        "python3", "-m", "unitylink", "bridge", "ros1", f"{device.url}?timeout=2", str(SPECS["walker18"])
    )
    echo(ros, "/walker18/joint_states")
    bag = ros.folder / "walk.bag"
    ros.run("rosbag", "record", "-O", str(bag), "-l", "5", "/walker18/joint_states")
    with AnyReader([bag]) as reader:
        messages = [reader.deserialize(raw, c.msgtype) for c, _, raw in reader.messages()]
    assert len(messages) == 5
    for message in messages:
        assert len(message.name) == len(message.position) == 18
        assert message.name[0] == "leg_0_hip"
    ros.publish("/walker18/joint_commands", "sensor_msgs/JointState", "{name: [leg_5_foot], position: [0.5]}")
    ros.until(lambda: device.registers[0x186] == 500)
