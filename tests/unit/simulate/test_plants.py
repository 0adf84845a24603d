# SPDX-License-Identifier: BSD-3-Clause
"""The plants: one that ramps, one that echoes, and a robot that keeps its limits."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.errors import UnityLinkError, UrlError
from unitylink.layer2_message import Link
from unitylink.simulate import Board, LoopbackPlant, RampPlant, ScaraPlant, load_plant, simulated_board
from unitylink.simulate.plants import Axis, Joint, ServoNames, ServoPlant
from unitylink.simulate.plants.scara import COUNTS_PER_UNIT, JOINTS
from unitylink.spec import Spec, compile_text, load

SCARA = Path(__file__).resolve().parents[3] / "examples" / "scara" / "scara.ul"
TEXT = """public board() {
  @out1 = 0x00: WRITE();  @out2 = 0x01: WRITE();
  @in1 = 0x10: READ();    @in2 = 0x11: signed READ();   @in3 = 0x12: signed READ();
}"""


@pytest.fixture(scope="module")
def spec() -> Spec:
    result = compile_text(TEXT, "board.ul")
    assert result.spec is not None
    return result.spec


@pytest.fixture(scope="module")
def scara() -> Spec:
    return load(SCARA)


def soon(condition: Callable[[], Any]) -> None:
    for _ in range(200_000):
        if condition():
            return
    pytest.fail("it never came true")


def test_ramp_is_the_default_and_every_read_moves_within_its_sign(spec: Spec) -> None:
    with Board(spec) as board, Link(f"{board.url}?timeout=10") as link:
        first = link.read_many([0x10, 0x11, 0x12])
        soon(lambda: all(link.read_many([0x10, 0x11, 0x12]) != first))
        assert 0 <= board.registers[0x10] < 2000
        assert -1000 <= board.registers.signed(0x11) < 1000
        assert link.read(0x00) == 0


def test_loopback_echoes_by_position_and_ramps_the_rest(spec: Spec) -> None:
    with Board(spec, plant=LoopbackPlant()) as board, Link(f"{board.url}?timeout=10") as link:
        link.write_many([0x00, 0x01], [111, 222])
        soon(lambda: list(link.read_many([0x10, 0x11])) == [111, 222])
        moving = link.read(0x12)
        soon(lambda: link.read(0x12) != moving)


def test_ramp_and_loopback_through_tosnet(scara: Spec) -> None:
    with Board(scara, plant=RampPlant()) as board, Link(f"{board.url}?timeout=10") as link:
        first = link.read(0x88)
        soon(lambda: link.read(0x88) != first)
    with Board(scara, plant=LoopbackPlant()) as board, Link(f"{board.url}?timeout=10") as link:
        link.write_many([0x8C, 0x94], [5, 6])
        link.write(0x400, 0)  # commit
        soon(lambda: link.read(0x88) == 5)


class Words(dict[int, int]):
    """Registers without a board."""

    data_bits = 32

    def signed(self, address: int) -> int:
        value = self[address] & 0xFFFFFFFF
        return value - (1 << 32) if value >> 31 else value

    def read_many(self, addresses: Sequence[int]) -> list[int]:
        return [self[address] & 0xFFFFFFFF for address in addresses]

    def write_many(self, addresses: Sequence[int], words: Sequence[int]) -> None:
        self.update(zip(addresses, words, strict=True))


def test_scara_moves_all_joints_to_their_set_points_and_clamps_at_the_stops(scara: Spec) -> None:
    plant, words = ScaraPlant(), Words()
    targets = {0: 4500, 1: -9000, 2: 999_999, 3: 18_000}
    for joint in range(4):
        words[0x8C + joint], words[0x94 + joint] = targets[joint], 20_000
    plant.attach(scara, words)  # type: ignore[arg-type]
    fastest = 0
    for step in range(3000):
        plant.step(step * plant.period_s)
        fastest = max(fastest, words[0x80])
    assert [words[0x88 + joint] for joint in (0, 1, 3)] == [4500, -9000, 18_000]
    assert words[0x88 + 2] == JOINTS[2].high * COUNTS_PER_UNIT  # the mechanical stop
    assert [words[0x80 + joint] for joint in range(4)] == [0, 0, 0, 0]
    assert 19_000 < fastest < 21_500  # it reaches the speed set-point, and hardly more


def test_scara_holds_where_it_is_with_speed_zero_and_is_deterministic(scara: Spec) -> None:
    runs = []
    for _ in range(2):
        plant, words = ScaraPlant(), Words()
        plant.attach(scara, words)  # type: ignore[arg-type]
        words.update({0x8C + j: 5000 for j in range(4)} | {0x94 + j: 10_000 for j in range(4)})
        trace = []
        for step in range(400):
            if step == 200:
                words.update({0x94 + j: 0 for j in range(4)})
            plant.step(step * plant.period_s)
            trace.append(words[0x88])
        runs.append(trace)
    assert runs[0] == runs[1]
    assert 0 < runs[0][-1] < 5000
    assert runs[0][-1] == runs[0][-50]


@settings(max_examples=many(40), deadline=None)
@given(
    st.sampled_from(JOINTS),
    st.lists(st.tuples(st.floats(-500, 500), st.floats(0, 2000)), min_size=1, max_size=5),
    st.floats(0.5, 1.2),
)
def test_a_joint_never_leaves_its_limits(
    joint: Joint, moves: list[tuple[float, float]], inertia: float
) -> None:
    axis = Axis(joint)
    for target, speed in moves:
        for _ in range(300):
            axis.step(target, speed, inertia, 0.001)
            assert joint.low <= axis.position <= joint.high
            assert abs(axis.speed) <= joint.speed_limit * 1.15
    for _ in range(4000):
        axis.step(moves[-1][0], joint.speed_limit, inertia, 0.001)
    assert axis.position == pytest.approx(max(joint.low, min(joint.high, moves[-1][0])), abs=1e-3)


def test_scara_through_the_link_and_its_commits(scara: Spec) -> None:
    with Board(scara, plant=ScaraPlant()) as board, Link(f"{board.url}?timeout=10") as link:
        link.write_many([0x8C, 0x94], [1500, 36_000])
        assert link.read(0x88) == 0
        link.write(0x400, 0)
        soon(lambda: link.read(0x88) == 1500)
        assert board.error is None


def test_scara_needs_joints(spec: Spec) -> None:
    with pytest.raises(UnityLinkError, match="0 of the 4 joints"):
        Board(spec, plant=ScaraPlant())


GOOD = """
class Plant:
    period_s = 0.002
    def attach(self, spec, registers): self.registers = registers
    def step(self, time_s): self.registers[0x10] = 4711
"""


def test_a_plant_of_ones_own_from_a_file(tmp_path: Path, spec: Spec) -> None:
    file = tmp_path / "mine.py"
    for text in (GOOD, GOOD + "def make_plant(spec):\n    return Plant()\n"):
        file.write_text(text)
        with Board(spec, plant=load_plant(str(file), spec)) as board, Link(f"{board.url}?timeout=10") as link:
            soon(lambda link=link: link.read(0x10) == 4711)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "neither a class Plant nor"),
        ("from unitylink.simulate import Plant", "neither a class Plant nor"),
        ("1/0", "ZeroDivisionError"),
        ("def (", "SyntaxError"),
        ("raise SystemExit(3)", "SystemExit"),
        ("class Plant: pass", "period_s is None"),
        ("class Plant: period_s = -1", "period_s is -1"),
        ("class Plant: period_s = 0.1", "no method attach()"),
        ("class Plant:\n  def __init__(self, colour): pass", "colour"),
    ],
)
def test_plant_files_that_are_none(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "mine.py"
    file.write_text(text)
    with pytest.raises(UnityLinkError) as caught:
        load_plant(str(file))
    assert words in str(caught.value)
    assert "mine.py" in str(caught.value)


@pytest.mark.parametrize(
    ("name", "words"), [("hamster", "choose ramp, loopback, scara"), ("absent.py", "no such file")]
)
def test_plants_that_are_not(name: str, words: str) -> None:
    with pytest.raises(UnityLinkError, match=words):
        load_plant(name)


def test_sim_url_makes_the_board_and_passes_other_options_to_the_link() -> None:
    board, url = simulated_board(f"sim:{SCARA}?plant=scara&fifo=1024&data_bits=32&timeout=0.2")
    with board, Link(url) as link:
        assert isinstance(board.plant, ScaraPlant)
        assert board.configuration.fifo == 1024
        assert "plant" not in url
        assert "timeout=0.2" in url
        assert link.read(0x88) == 0


@pytest.mark.parametrize(
    ("url", "words"),
    [
        ("sim:", "expected sim:SPEC.ul"),
        (f"sim:{SCARA}?fifo=many", "not a whole number"),
        (f"sim:{SCARA}?plant", "bad query"),
        (f"sim:{SCARA}?root=arm", "no public constructor 'arm'; there are: scara"),
    ],
)
def test_sim_urls_that_are_none(url: str, words: str) -> None:
    with pytest.raises(UrlError, match=words):
        simulated_board(url)


def test_servos_follow_within_their_limits(scara: Spec) -> None:
    names = ServoNames("cpos", "pos_sp", "spd", "spd_sp")
    plant = ServoPlant(
        [names], Joint("j", "rad", -2.0, 2.0, speed_limit=4.0, acceleration_limit=40.0), step=0.01
    )
    registers = Words(dict.fromkeys(range(0x400), 0))
    plant.attach(scara, registers)  # type: ignore[arg-type]
    assert len(plant.servos) == 4
    registers[0x8C], registers[0x94] = 100, 100  # 1 rad at 1 rad/s
    registers[0x8D], registers[0x95] = (-500) & 0xFFFFFFFF, 1000  # a target beyond its stop, at full speed
    for step in range(300):
        plant.step(step * plant.period_s)
    assert 45 <= registers[0x88] <= 65, "0.6 s at 1 rad/s, after a start"
    assert registers[0x89] == (-200) & 0xFFFFFFFF
    for step in range(600):
        plant.step(step * plant.period_s)
    assert registers[0x88] == 100 and registers[0x80] == 0


def test_servos_need_a_spec_that_has_some(spec: Spec) -> None:
    plant = ServoPlant([ServoNames("pos", "sp")], JOINTS[0])
    with pytest.raises(UnityLinkError, match="no instance of the spec has pos and sp"):
        plant.attach(spec, Words())  # type: ignore[arg-type]


def test_one_board_of_a_spec_of_several(tmp_path: Path) -> None:
    file = tmp_path / "two.ul"
    file.write_text("public a() { @x = 0x1: READ(); }\npublic b() { @y = 0x2: READ(); @z = 0x3: WRITE(); }\n")
    board, _ = simulated_board(f"sim:{file}?root=b")
    with board:
        assert board.spec is not None and [path for path, _ in board.spec.walk()] == ["y", "z"]
