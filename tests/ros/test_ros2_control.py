# SPDX-License-Identifier: BSD-3-Clause
"""The generated plug-in of ros2_control, compiled for three releases with our stubs, and run on the twin."""

from __future__ import annotations

import math
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from xml.etree import ElementTree

import pytest

from unitylink.generate import generate, write
from unitylink.simulate import Board
from unitylink.spec import load

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
SPEC = load(HERE / "control.ul")
RELEASES = ("humble", "jazzy", "rolling")
PATIENCE_S = 60.0
CLEAN = "allocations 0 waits 0 thrown 0 failed 0"
pytestmark = pytest.mark.xdist_group("ros2_control")  # the programs are compiled once for all of these tests


class Still:
    """A plant that leaves the registers alone."""

    period_s = 0.001

    def attach(self, spec: object, registers: object) -> None: ...
    def step(self, time_s: float) -> None: ...


class Manager:
    """The plug-in in its loop: it gets an order, and answers with a line."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process

    def ask(self, order: str) -> str:
        assert self.process.stdin is not None and self.process.stdout is not None
        print(order, file=self.process.stdin, flush=True)
        return self.process.stdout.readline().strip()

    def state(self, name: str) -> float:
        return float(self.ask(f"get {name}"))


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("control")
    write(SPEC, folder, "ros2")
    compiler = shutil.which("c++")
    assert compiler, "no C++ compiler: install the Debian package g++"
    native = ROOT / "build" / "native"
    command = [compiler, "-std=c++17", "-O0", "-Wall", "-Wextra", "-Werror", "-DPACKAGE=arm_unitylink"]
    command += [f"-I{folder / 'ros2' / 'arm_unitylink' / 'src'}", f"-I{ROOT / 'native' / 'include'}"]
    library = [f"-L{native}", f"-Wl,-rpath,{native}", "-lunitylink", "-ldl", "-pthread"]
    made = {}
    for release in RELEASES:
        made[release] = folder / release
        stubs = [f"-I{HERE / 'stubs' / release}", f"-I{HERE / 'stubs'}"]
        source = [str(HERE / "control_loop.cpp"), "-o", str(made[release])]
        done = subprocess.run(
            [*command, *stubs, *source, *library], capture_output=True, text=True, check=False
        )
        assert done.returncode == 0, f"{release}: {done.stderr}"
    return made


@contextmanager
def running(program: Path, url: str, *arguments: str) -> Iterator[Manager]:
    command = [program, f"link={url}?timeout=5", *arguments]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        try:
            yield Manager(process)
            assert process.stdin is not None
            process.stdin.close()
            assert process.wait(timeout=PATIENCE_S) == 0
        finally:
            process.kill()


def until(holds: Callable[[], object]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < deadline, "waited in vain"
        time.sleep(0.005)


@pytest.mark.parametrize("release", RELEASES)
def test_a_life_on_a_link_that_is_lost(programs: dict[str, Path], release: str) -> None:
    with Board(SPEC, plant=Still(), endpoint="tcp") as board:
        board.registers[0x10], board.registers[0x11], board.registers[0] = 900, 0x10000 - 1800, 2
        board.registers[2], board.registers[5] = 0b0000111, 0b0100  # on, level 3; b 2
        listed = [">arm/mode:uint8", ">arm/lamp.on:bool", ">arm/lamp.level:double", "j_0/position"]
        with running(programs[release], board.url, *listed) as manager:
            assert manager.ask("configure") == "inactive"
            assert manager.ask("cycle 100") == f"{CLEAN} inactive"
            assert manager.state("j_0/position") == pytest.approx(math.pi / 2)
            assert manager.state("j_0/velocity") == pytest.approx(-math.pi)
            assert [manager.state(f"arm/seen.{name}") for name in ("on", "level")] == [1, 6]
            types = dict(one.rsplit(":", 1) for one in manager.ask("names").split())
            typed = {"rolling": ("uint8", "bool", "int16"), "jazzy": ("double", "bool", "double")}
            names = (">arm/mode", ">arm/lamp.on", "arm/count")
            assert tuple(types[name] for name in names) == typed.get(release, ("double",) * 3)
            assert types["head/angular_velocity.z"] == types["arm/link.age_s"] == "double"

            assert manager.ask("activate") == "active"
            assert manager.ask("cycle 100") == f"{CLEAN} active"
            assert board.registers[0] == 2, "nothing is commanded until a controller does"
            manager.ask("set j_0/position 0.5")
            manager.ask("set arm/mode 1")
            manager.ask("set arm/lamp.on 1")
            manager.ask("set arm/knob.a 1")
            assert manager.ask("cycle 1000") == f"{CLEAN} active"
            until(lambda: (board.registers[0x12], board.registers[0]) == (286, 1))
            until(lambda: board.registers[5] == (0b0101 if release == "rolling" else 0b0100))
            assert board.registers[1] == 0, "packed bits are written when each field has a command"
            manager.ask("set arm/lamp.level 8")
            assert manager.ask("cycle 10") == f"{CLEAN} active"
            until(lambda: board.registers[1] == 0b1001)
            manager.ask(
                "set j_1/position 100"
            )  # beyond its limits: it is refused, and the others are written
            manager.ask("set j_1/velocity 1")
            manager.ask("cycle 10")
            until(lambda: board.registers[0x1B] == 573)
            assert board.registers[0x1A] == 0 and manager.ask("cycle 1") == f"{CLEAN} active"
            assert manager.state("arm/link.refused") == 1

            board.hang_up()
            until(lambda: "failed 1 unconfigured" in manager.ask("cycle 1000"))
            until(lambda: board.registers[0x12] == 90)  # SAFE, when the device is back
            assert manager.ask("configure") == "inactive"
            assert manager.ask("activate") == "active"
            assert manager.ask("cycle 1000") == f"{CLEAN} active"
            time.sleep(0.05)
            assert board.registers[0x12] == 90, "a command from before the loss is gone"
            assert manager.state("arm/link.lost") >= 1
            manager.ask("set j_0/position 0.25")
            assert manager.ask("cycle 10") == f"{CLEAN} active"
            until(lambda: board.registers[0x12] == 143)
            assert manager.ask("deactivate") == "inactive"
            assert board.registers[0x12] == 90, "deactivation is safe"
            assert manager.ask("cycle 10") == f"{CLEAN} inactive"
            assert manager.ask("cleanup") == "unconfigured"
            assert manager.ask("configure") == "inactive"
            assert manager.ask("shutdown") == "finalized"


def test_the_device_paces_the_loop_and_a_slow_bus_is_an_error(programs: dict[str, Path]) -> None:
    with Board(SPEC, plant=Still(), endpoint="tcp") as board:
        with running(programs["rolling"], board.url, "pace_s=0.5", "types=double") as manager:
            assert ">arm/mode:double" in manager.ask("names")
            assert manager.ask("configure") == "inactive"
            begun = time.monotonic()
            assert manager.ask("cycle 30").endswith("thrown 0 failed 0 inactive")
            assert 0.25 < time.monotonic() - begun < 5, "30 publishes of 100 Hz"
        with running(programs["rolling"], board.url, "stale_s=0.002") as manager:
            assert manager.ask("configure") == "inactive"
            board.registers[0x12] = 286
            until(lambda: "failed 1 unconfigured" in manager.ask("cycle 1000000"))
            until(lambda: board.registers[0x12] == 90)  # made safe, though the link is up


def test_a_loop_that_hangs_does_not_go_on_as_if_nothing_was(programs: dict[str, Path]) -> None:
    """The device was made safe meanwhile, so the controllers' commands are not what it has."""
    with (
        Board(SPEC, plant=Still(), endpoint="tcp") as board,
        running(programs["humble"], board.url) as manager,
    ):
        assert [manager.ask(order) for order in ("configure", "activate")] == ["inactive", "active"]
        manager.ask("set j_0/position 0.5")
        assert manager.ask("cycle 10") == f"{CLEAN} active"
        until(lambda: board.registers[0x12] == 286)
        until(lambda: board.registers[0x12] == 90)  # nobody calls read() for a second
        assert "failed 1 unconfigured" in manager.ask("cycle 10")
        assert board.registers[0x12] == 90


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["link="], "no link"),
        (["link=tcp://x", "elbow/position"], "the spec has no interface 'elbow/position'"),
        (["link=tcp://x", "stale_s=soon"], "the parameter stale_s is 'soon': give a number of seconds"),
    ],
)
def test_what_is_wrong_is_said(programs: dict[str, Path], arguments: list[str], said: str) -> None:
    done = subprocess.run([programs["humble"], *arguments], capture_output=True, text=True, check=False)
    assert done.returncode == 2 and said in done.stderr


def test_the_tag_and_the_controllers_name_the_interfaces() -> None:
    files = generate(SPEC, "ros2")
    tag = ElementTree.fromstring(files["ros2/arm_unitylink/urdf/arm.ros2_control.xacro"])
    parts = {part.get("name"): part for kind in ("joint", "gpio", "sensor") for part in tag.iter(kind)}
    kinds = {name: part.tag for name, part in parts.items()}
    assert kinds == {
        **dict.fromkeys(("j_0", "j_1"), "joint"),
        **dict.fromkeys(("head", "j_0_io", "j_1_io"), "sensor"),
        "arm": "gpio",
    }
    interfaces = [(one.tag, one.get("name"), one.get("data_type")) for one in parts["arm"]]
    assert interfaces == [
        ("command_interface", "mode", "uint8"),
        ("command_interface", "lamp.on", "bool"),
        ("command_interface", "lamp.level", None),
        ("command_interface", "knob.a", "bool"),
        ("command_interface", "knob.b", "uint8"),
        ("state_interface", "mode", "uint8"),
        ("state_interface", "seen.on", "bool"),
        ("state_interface", "seen.level", None),
        ("state_interface", "count", "int16"),
    ]
    assert "<!-- 0 idle, 1 run, 2 hold -->" in files["ros2/arm_unitylink/urdf/arm.ros2_control.xacro"]
    controllers = files["ros2/arm_unitylink/config/controllers.yaml"]
    assert "joint_trajectory_controller/JointTrajectoryController" in controllers
    assert "      - j_1\n" in controllers and "gpio_controllers/GpioCommandController" in controllers
    lone = load(ROOT / "examples" / "scara" / "scara.ul")
    assert "joint_trajectory" not in generate(lone, "ros2")["ros2/scara_unitylink/config/controllers.yaml"]
