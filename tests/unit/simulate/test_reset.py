# SPDX-License-Identifier: BSD-3-Clause
"""A board in steps begins anew in its place: the bytes are those of a board that has just been made."""

from __future__ import annotations

import threading
from pathlib import Path
from typing import Any

import pytest

from unitylink import connect
from unitylink.capture.pcapng import read_packets
from unitylink.errors import LinkClosed, LinkError, UnityLinkError
from unitylink.layer2_message import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board, Registers
from unitylink.spec import Spec, compile_text

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"
SCARA = EXAMPLES / "scara" / "scara.ul"

NOISY = """
import random
class Plant:
    period_s = 0.001
    def __init__(self):
        self.seed(0)
        self.at = 0.0
        self.list = []
    def seed(self, number):
        self.random = random.Random(number)
    def attach(self, spec, registers):
        self.registers = registers
    def step(self, time_s):
        self.at += 0.001 * self.registers.signed(0x20) + self.random.gauss(0, 3)
        self.list.append(time_s)
        self.registers[0x10] = round(self.at) & 0xFFFFFFFF
"""


@pytest.fixture
def noisy(tmp_path: Path) -> str:
    (tmp_path / "noisy.ul").write_text(
        "public noisy() {\n @x = 0x10: i32 READ(PUBLISH(100 Hz));\n @v = 0x20: i32 WRITE(SAFE=0);\n}\n"
    )
    (tmp_path / "noisy.py").write_text(NOISY)
    return f"sim:{tmp_path / 'noisy.ul'}?plant={tmp_path / 'noisy.py'}"


def episode(link: Link, read: int = 0x10, write: int = 0x20) -> list[object]:
    seen: list[object] = []
    subscription = link.subscribe([read], divisor=10)
    begun_s = link.now_s()
    subscription.on_publish(lambda time_s, words: seen.append((round(time_s - begun_s, 9), *words)))
    for turn in range(100):
        link.write(write, (turn * 7 % 23 - 11) & 0xFFFF)
        seen.append(link.read(read))
        link.step(0.001)
    return seen


def sent(file: Path) -> list[tuple[object, bytes]]:
    return [(packet.direction, packet.data) for packet in read_packets(file)]


@pytest.mark.parametrize("protocol", ["framed", "classic"])
@pytest.mark.parametrize("used", [0, 1, 57])
def test_after_a_reset_the_bytes_are_those_of_a_new_board(
    noisy: str, tmp_path: Path, protocol: str, used: int
) -> None:
    url = f"{noisy}&protocol={protocol}&time=lockstep&trace="
    with connect(f"{url}{tmp_path / 'fresh'}&seed=7") as link:
        fresh = episode(link)
    with connect(f"{url}{tmp_path / 'again'}&seed=3") as link:
        if used:
            other = episode(link)
            assert other != fresh
            link.step(0.0001 * used)
        link.reset(seed=7)
        assert episode(link) == fresh
        link.reset()  # the seed of the URL
        assert sent(tmp_path / "again-2") == sent(tmp_path / "fresh")
        assert episode(link) != fresh
        assert len(link.board.plant.list) in (100, 101)


@pytest.mark.parametrize(
    ("spec", "plant", "read", "write"),
    [
        (SCARA, "scara", 0x88, 0x8C),
        (SCARA, "ramp", 0x88, 0x8C),
        (EXAMPLES / "belt_axis" / "belt_axis.ul", EXAMPLES / "belt_axis" / "plant.py", 0x40, 0x3),
    ],
)
def test_networks_and_components_begin_anew_too(
    spec: Path, plant: Path | str, read: int, write: int, tmp_path: Path
) -> None:
    url = f"sim:{spec}?plant={plant}&time=lockstep&trace="
    runs, bytes_sent = [], []
    with connect(f"{url}{tmp_path / 'trace.pcapng'}") as link:
        for name in ("trace.pcapng", "trace-2.pcapng", "trace-3.pcapng"):
            robot: Any = load_spec_objects(link.board.spec, link)
            for value in robot:
                if "control" in value.path and "motor" in value.path:
                    value.write({"enable": True, "coast": False})
            runs.append((episode(link, read, write), dict(robot.snapshot())))
            link.reset()
            bytes_sent.append(sent(tmp_path / name))
    assert len(bytes_sent[0]) > 300
    assert runs[0] == runs[1] == runs[2]
    assert bytes_sent[0] == bytes_sent[1] == bytes_sent[2]


def test_objects_stay_and_what_they_publish_goes_on(noisy: str) -> None:
    with connect(noisy, time="lockstep") as link:
        robot: Any = load_spec_objects(link.board.spec, link)
        plant, board = link.board.plant, link.board
        seen: list[int] = []
        robot["x"].on_publish(lambda time_s, value: seen.append(value))
        group = link.exchange_group(reads=[0x10])
        link.step(0.1)
        assert seen
        robot["v"].write(5)
        first, generation = list(seen), link.generation
        link.reset()
        assert (link.board, link.board.plant) == (board, plant)
        assert link.read(0x20) == 0 and link.generation != generation
        seen.clear()
        link.step(0.1)
        assert seen == first
        with pytest.raises(LinkError):
            group.exchange([])
        assert board.time_s < 0.2 and board.statistics.plant_steps < 200


def test_what_a_plant_put_at_pins_is_gone_and_put_there_again() -> None:
    class Plant:
        period_s = 0.001

        def attach(self, spec: Spec | None, registers: Registers) -> None:
            self.part = registers.components["imu"]
            self.part.device[5] = 17
            self.pwm = registers.components["drive"]

        def step(self, time_s: float) -> None:
            self.duty = self.pwm.duty("pins", 0)

    spec = compile_text(
        "link arm (ADDRESS=8);\npublic arm() {\n imu: spi_device(command=0x90, bytes=2, period=1 ms);\n"
        " drive: pwm(channels=1);\n}\n",
        "arm.ul",
    ).spec
    with Board(spec, plant=Plant(), endpoint="lockstep") as board:
        link = Link(board.url)
        link.board = board
        robot: Any = load_spec_objects(spec, link)
        robot["drive.control"].write({"enable": True})
        robot["drive.width[0]"].write(0.5)
        link.step(0.01)
        assert board.plant.duty == pytest.approx(0.5, abs=0.1)
        board.components["imu"].device[5] = 99
        link.reset()
        assert board.components["imu"].device[5] == 17
        link.step(0.01)
        assert board.plant.duty == 0
        link.close()


def test_what_cannot_begin_anew_is_told(noisy: str, tmp_path: Path) -> None:
    with connect(noisy) as link, pytest.raises(UnityLinkError, match="passes by itself cannot be reset"):
        link.reset()

    class Stuck:
        period_s = 0.001

        def __init__(self) -> None:
            self.lock = threading.Lock()

        def attach(self, spec: Spec | None, registers: Registers) -> None:
            self.registers = registers

        def step(self, time_s: float) -> None:
            pass

    with Board(endpoint="lockstep", plant=Stuck()) as board:
        link = Link(board.url)
        with pytest.raises(UnityLinkError, match="hardware is where it is"):
            link.reset()
        link.board = board
        with pytest.raises(
            UnityLinkError, match=r"plant Stuck cannot be put back.*give it a method reset\(\)"
        ):
            link.reset()
        link.step(0.01)  # nothing has happened to it
        link.close()
        with pytest.raises(LinkClosed):
            link.step(0.1)

    class Own(Stuck):
        resets = 0
        board: Board | None = None

        def reset(self) -> None:
            self.resets += 1

        def step(self, time_s: float) -> None:
            if self.board is not None:
                self.board.reset()

    plant = Own()
    with Board(endpoint="lockstep", plant=plant) as board, Link(board.url) as link:
        link.board = board
        link.reset()
        assert plant.resets == 1
        plant.board = board
        link.step(0.01)
        assert "wants to reset it in a step" in str(board.error)
        plant.board = None
        link.reset()
        assert board.error is None
        board.close()
        with pytest.raises(UnityLinkError, match="the board is closed"):
            link.reset()
        assert link.closed
