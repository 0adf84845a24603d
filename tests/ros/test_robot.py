# SPDX-License-Identifier: BSD-3-Clause
"""The library below a generated C++ node, without ROS: numbers, lost links, a program that hangs, other
gateware.
"""

from __future__ import annotations

import math
import random
import shutil
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest

from unitylink import connect
from unitylink.errors import UnityLinkError
from unitylink.generate import write
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text, load

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
SPEC = load(HERE / "robot.ul")
PATIENCE_S = 60.0
pytestmark = pytest.mark.xdist_group("robot")  # one program is compiled for all of these tests


@pytest.fixture(scope="module")
def program(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("robot")
    write(SPEC, folder, "ros1")
    compiler = shutil.which("c++")
    assert compiler, "no C++ compiler: install the Debian package g++"
    native = ROOT / "build" / "native"
    command = [
        compiler,
        *("-std=c++17", "-O1", "-Wall", "-Wextra", "-Werror"),
        f"-I{folder / 'ros1' / 'every_unitylink' / 'src'}",
        f"-I{ROOT / 'native' / 'include'}",
        *(str(HERE / "robot_loop.cpp"), "-o", str(folder / "robot_loop")),
        *(f"-L{native}", f"-Wl,-rpath,{native}", "-lunitylink", "-pthread"),
    ]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return folder / "robot_loop"


class Still:
    """A plant that leaves the registers alone."""

    period_s = 0.001

    def attach(self, spec: object, registers: object) -> None: ...
    def step(self, time_s: float) -> None: ...


class Running:
    """The program, its answers and its output."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self.process = process
        self.said: list[str] = []
        self.answers: list[str] = []
        self._thread = threading.Thread(target=self._read)
        self._thread.start()

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            (self.said if line.startswith("say ") else self.answers).append(line.strip())

    def tell(self, line: str) -> None:
        assert self.process.stdin is not None
        print(line, file=self.process.stdin, flush=True)

    def ask(self, line: str) -> str:
        known = len(self.answers)
        self.tell(line)
        until(lambda: len(self.answers) > known, self)
        return self.answers[known]

    def end(self) -> None:
        assert self.process.stdin is not None
        self.process.stdin.close()
        assert self.process.wait(timeout=PATIENCE_S) == 0
        self._thread.join()


@contextmanager
def running(program: Path, url: str) -> Iterator[Running]:
    with subprocess.Popen(
        [program, url], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as process:
        made = Running(process)
        try:
            yield made
            made.end()
        finally:
            process.kill()


def until(holds: Callable[[], object], robot: Running | None = None) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not holds():
        assert time.monotonic() < deadline, (robot.said, robot.answers) if robot else "waited in vain"
        time.sleep(0.005)


def is_up(robot: Running) -> bool:
    return robot.ask("health")[7] in "01"


def test_numbers_are_those_of_python(program: Path) -> None:
    """Both languages read the same number, and write the same word or refuse it."""
    random_ = random.Random(3)
    hostile = [
        math.nan,
        math.inf,
        -math.inf,
        1e308,
        -1e308,
        3.5e38,
        3.4028235e38,
        1e-320,
        0.0,
        -0.0,
        0.5,
        1.5,
        2.0,
        2.5,
        3.0,
    ]
    lines, expected = [], []
    with Board(SPEC) as board, connect(board.url) as link:
        tree = load_spec_objects(SPEC, link)
        for index, value in enumerate(tree):
            codec, kind = value.codec, value.quantity.type
            width = codec.width
            raws = {0, 1, 2, 3, 1254, (1 << width) - 1, 1 << width - 1, (1 << width - 1) - 1}
            raws |= {random_.randrange(1 << width) for _ in range(60)}
            if kind.kind != "enum":
                for raw in sorted(raws):
                    if raw < 1 << width and not (
                        kind.kind == "float" and not math.isfinite(codec.decode(raw))
                    ):
                        lines.append(f"number {index} {raw}")
                        expected.append(f"{float(codec.decode(raw)):.17g}")
            limits = [x for x in (value.quantity.minimum, value.quantity.maximum) if x is not None]
            near = [float(limit + step) for limit in limits for step in (-1, -0.01, 0, 0.01, 1)]
            whole = [float(random_.randrange(-400, 400)) for _ in range(30)]
            broken = [random_.uniform(-400, 400) for _ in range(30)]
            for number in (*hostile, *near, *whole, *broken):
                try:
                    plain = number.is_integer() and not value.quantity.scaled and kind.kind != "float"
                    given = int(number) if plain else number
                    given = bool(given) if kind.kind == "bool" and given in (0, 1) else given
                    word = str(codec.encode(given))
                except UnityLinkError:
                    word = "none"
                lines.append(f"encode {index} {number!r}")
                expected.append(word)
    done = subprocess.run([program], input="\n".join(lines), capture_output=True, text=True, check=True)
    found = done.stdout.splitlines()
    assert len(found) == len(expected) > 1000
    wrong = [one for one in zip(lines, found, expected, strict=True) if one[1] != one[2]]
    assert not wrong, wrong[:20]


def test_a_joint_state_is_taken_whole_or_refused(program: Path) -> None:
    """As in Python (tests/unit/ros/test_node.py)."""
    asked = {
        "2 j_1 j_0 0.5 -0.25": "j[1].pos_sp=0.5 j[0].pos_sp=-0.25",
        "2 j_0 j_0 0.1 0.2": "the joint 'j_0' is named twice; name each once",
        "3 j_0 j_1 j_0 0.1 0.2 0.3": "the joint 'j_0' is named twice; name each once",
        "2 j_0 j_7 0.1 0.2": "no joint is called 'j_7'",
        "2 j_0 j_1 0.1": "a JointState with another number of names than of values",
        "0": "the message sets no joint",
    }
    lines = "\n".join(f"joints {message}" for message in asked)
    done = subprocess.run([program], input=lines, capture_output=True, text=True, check=True)
    assert [line.strip() for line in done.stdout.splitlines()] == list(asked.values())


def test_after_a_lost_line_the_outputs_are_safe_and_old_commands_are_gone(program: Path) -> None:
    with Board(SPEC, plant=Still(), endpoint="tcp") as board:
        with running(program, f"{board.url}?timeout=5") as robot:
            until(lambda: is_up(robot), robot)
            assert robot.ask("set position 1.25") == "set"
            until(lambda: board.registers[0x10] == 125)
            assert "out of its limits" in robot.ask("set position 1e308")
            board.hang_up()
            until(
                lambda: any("the device is back; safe values written" in said for said in robot.said), robot
            )
            until(lambda: is_up(robot), robot)
            assert board.registers[0x10] == 25
            assert any("the link is lost" in said for said in robot.said)
            assert robot.ask("set position -1") == "set"
            until(lambda: board.registers[0x10] == 0xFF9C)
        assert board.registers[0x10] == 25, "the end is safe"


def test_a_program_that_hangs_does_not_keep_the_board_alive(program: Path) -> None:
    with (
        Board(SPEC, plant=Still(), endpoint="tcp") as board,
        running(program, f"{board.url}?timeout=5") as robot,
    ):
        until(lambda: is_up(robot), robot)
        assert robot.ask("set position 1.25") == "set"
        until(lambda: board.registers[0x10] == 125)
        robot.tell("hang 3.5")
        robot.tell("health")
        until(lambda: board.registers[0x10] == 25)
        until(lambda: any("the program's thread has not moved on" in said for said in robot.said), robot)
        until(lambda: any("no sign of life" in said for said in robot.said), robot)
        assert "hung" not in robot.answers, "all of that while it hung"
        until(lambda: "hung" in robot.answers, robot)
        until(lambda: is_up(robot), robot)
        assert any("armed again" in said for said in robot.said), "the dead-man had tripped"
        assert robot.ask("set position 0.5") == "set"
        until(lambda: board.registers[0x10] == 50)


def test_safe_values_are_refused_on_a_link_that_has_fallen_back_to_the_classic_protocol(
    program: Path,
) -> None:
    with Board(
        SPEC, plant=Still(), endpoint="tcp", configuration=BoardConfiguration(protocol="classic")
    ) as board:
        with running(program, f"{board.url}?timeout=5") as robot:
            until(lambda: any("has fallen back to the classic one" in said for said in robot.said), robot)
            said = next(said for said in robot.said if "has fallen back" in said)
            assert "has a SAFE value, which needs the framed protocol" in said
            assert "add protocol=classic to the URL" in said
            assert not is_up(robot)
            assert "not taken" in robot.ask("set position 1")
            assert board.registers[0x10] == 0
        with running(program, f"{board.url}?timeout=5&protocol=classic") as robot:
            until(lambda: is_up(robot), robot)


def test_registers_that_are_memory(program: Path, tmp_path: Path) -> None:
    """There is no device and no protocol: the same node runs on a file that another process could serve."""
    path = tmp_path / "registers"
    path.write_bytes(bytes(4096))
    words = np.memmap(path, dtype="<u4", mode="r+")
    with running(program, f"mmap:{path}") as robot:
        until(lambda: is_up(robot), robot)
        assert robot.ask("set position 1.25") == "set"
        until(lambda: words[0x10] == 125)
    assert words[0x10] == 25, "the end is safe"


def test_other_gateware_is_refused_by_its_hash(program: Path) -> None:
    other = compile_text(
        (HERE / "robot.ul").read_text().replace("= 0x11: u16", "= 0x11: i16"), "other.ul"
    ).spec
    with (
        Board(other, plant=Still(), endpoint="tcp") as board,
        running(program, f"{board.url}?timeout=5") as robot,
    ):
        until(
            lambda: any("was built from another" in said or "another spec" in said for said in robot.said),
            robot,
        )
        assert not is_up(robot)
        assert "not taken" in robot.ask("set position 1")
        assert board.registers[0x10] == 0
