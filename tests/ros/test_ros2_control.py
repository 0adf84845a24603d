# SPDX-License-Identifier: BSD-3-Clause
"""The generated plug-in of ros2_control, compiled with our stub headers and run against the twin."""

from __future__ import annotations

import shutil
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest

from unitylink.generate import generate, write
from unitylink.simulate import Board
from unitylink.spec import load

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
MakeBoard = Callable[..., Board]
pytestmark = pytest.mark.xdist_group("ros2_control")  # one program is compiled for all of these tests


@pytest.fixture(scope="module")
def loop(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("control")
    write(load(HERE / "rig.ul"), folder, "ros2")
    compiler = shutil.which("c++")
    assert compiler, "no C++ compiler: install the Debian package g++"
    program = folder / "control_loop"
    native = ROOT / "build" / "native"
    command = [
        compiler,
        "-std=c++17",
        "-O1",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-DPACKAGE=rig_unitylink",
        *(f"-I{path}" for path in (HERE / "stubs", folder / "ros2" / "rig_unitylink" / "src")),
        f"-I{ROOT / 'native' / 'include'}",
        str(HERE / "control_loop.cpp"),
        "-o",
        str(program),
        f"-L{native}",
        f"-Wl,-rpath,{native}",
        "-lunitylink",
        "-ldl",
        "-pthread",
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return program


def test_the_loop_neither_allocates_nor_locks(loop: Path, board: MakeBoard) -> None:
    device = board("rig", "still")
    device.registers[0x10], device.registers[0x11] = 500, 0xFF9C
    with subprocess.Popen(
        [loop, f"{device.url}?timeout=2"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write("0.5\n")
        process.stdin.flush()
        answer = process.stdout.readline()
        assert answer.startswith("allocations 0 locks 0 good 1"), answer
        assert "j_0/position=0.5" in answer and "j_0/velocity=-1" in answer
        deadline = time.monotonic() + 30
        while (device.registers[0x12], device.registers[0x1A]) != (500, 500):
            assert time.monotonic() < deadline, "the command has not arrived"
            time.sleep(0.01)
        process.stdin.close()
        assert process.wait(timeout=30) == 0
    assert device.registers[0x12] == 250, "deactivation is safe"


def test_what_is_wrong_is_said(loop: Path) -> None:
    done = subprocess.run([loop], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "no link" in done.stderr
    done = subprocess.run([loop, "tcp://x", "elbow"], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and "the spec has no joint 'elbow'" in done.stderr


def test_the_tag_and_the_controllers_name_the_joints() -> None:
    files = generate(load(HERE / "rig.ul"), "ros2")
    tag = ElementTree.fromstring(files["ros2/rig_unitylink/urdf/rig.ros2_control.xacro"])
    joints = tag.findall(".//joint")
    assert [joint.get("name") for joint in joints] == ["j_0", "j_1"]
    interfaces = [(one.tag, one.get("name")) for one in joints[0]]
    assert interfaces == [
        ("command_interface", "position"),
        ("command_interface", "velocity"),
        ("state_interface", "position"),
        ("state_interface", "velocity"),
    ]
    assert "      - j_1\n" in files["ros2/rig_unitylink/config/controllers.yaml"]
    scara = generate(load(ROOT / "examples" / "scara" / "scara.ul"), "ros2")
    assert not [name for name in scara if "control" in name], "a robot without joints has no plug-in"
