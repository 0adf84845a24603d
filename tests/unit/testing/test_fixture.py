# SPDX-License-Identifier: BSD-3-Clause
"""The fixture of the package, used as a user would."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from unitylink.errors import SpecError
from unitylink.simulate import Board
from unitylink.spec import load
from unitylink.testing import Simulated

LAMP = "public lamp() { @led = 0x10: WRITE(); @light = 0x11: signed READ(); }"
Sim = Callable[..., Simulated]


@pytest.fixture
def lamp(tmp_path: Path) -> Path:
    path = tmp_path / "lamp.ul"
    path.write_text(LAMP)
    return path


class Still:
    """A plant that changes nothing, so everything stays as the test sets it."""

    period_s = 0.01

    def attach(self, spec: object, registers: object) -> None: ...

    def step(self, time_s: float) -> None: ...


def test_both_sides_of_a_robot_are_at_hand(unitylink_sim: Sim, lamp: Path) -> None:
    sim = unitylink_sim(lamp, plant=Still())
    sim.robot["led"].write(1)  # type: ignore[union-attr]
    sim.registers[0x11] = -7
    assert sim.registers[0x10] == 1
    assert sim.robot["light"].read() == -7  # type: ignore[union-attr]


def test_several_robots_and_their_generics(unitylink_sim: Sim, lamp: Path) -> None:
    one, other = (
        unitylink_sim(lamp, plant=Still()),
        unitylink_sim(lamp, plant=Still(), data_bits=16, options="crc=1"),
    )
    assert one.link.configuration.data_bits == 32 and other.link.configuration.data_bits == 16
    one.link.write(0x10, 3)
    assert other.link.read(0x10) == 0


def test_a_wrong_spec_is_told(unitylink_sim: Sim, tmp_path: Path) -> None:
    (tmp_path / "wrong.ul").write_text("public wrong( { }")
    with pytest.raises(SpecError):
        unitylink_sim(tmp_path / "wrong.ul")
    with pytest.raises(SpecError, match=r"absent\.ul"):
        unitylink_sim("absent.ul")


def test_a_test_runs_on_each_board_and_all_is_closed_with_it(pytester: pytest.Pytester) -> None:
    """The specs are beside the test, not in the working folder."""
    folder = pytester.mkdir("robots")
    (folder / "lamp.ul").write_text(LAMP)
    (folder / "test_lamp.py").write_text("""
import pytest
kept = []
def test_one(unitylink_sim):
    kept.append(unitylink_sim("lamp.ul"))
    assert kept[0].robot["led"]
def test_other():
    assert kept[0].link.closed
def test_each(unitylink_board):
    lamp = unitylink_board("lamp.ul", plant="loopback", options="attempts=2")
    print("on", lamp.name, lamp.link.protocol, lamp.board is not None)
    lamp.robot["led"].write(3)
@pytest.mark.parametrize("unitylink_board", ["sim"], indirect=True)
def test_its_own(unitylink_board):
    assert unitylink_board("lamp.ul").name == "sim"
""")
    spec = load(folder / "lamp.ul")
    with Board(spec, endpoint="tcp") as board:
        boards = ["sim?protocol=classic", "sim", board.url]
        options = [f"--unitylink-board={place}" for place in boards]
        run = pytester.runpytest_subprocess("-p", "no:cacheprovider", "-s", *options, "robots")
        run.assert_outcomes(passed=6)
        wanted = ["sim?protocol=classic classic True", "sim framed True", f"{board.url} framed False"]
        run.stdout.fnmatch_lines([f"*on {line.replace('?', '[?]')}" for line in wanted])
        assert board.registers[0x10] == 3
