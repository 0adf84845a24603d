# SPDX-License-Identifier: BSD-3-Clause
"""The state of a virtual board: another one goes on from it, and each time with the same bytes."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink import connect
from unitylink.capture.pcapng import read_packets
from unitylink.errors import UnityLinkError, UrlError
from unitylink.layer2_message import Link
from unitylink.layer4_data import ValueGroup, load_spec_objects
from unitylink.simulate import BoardState
from unitylink.spec import load

SCARA = Path(__file__).parents[3] / "examples" / "scara" / "scara.ul"


def moved(link: Link, turns: range) -> list[object]:
    """Move the SCARA, and return what is seen."""
    robot = load_spec_objects(load(SCARA), link)
    joints = [robot[f"j{number}"] for number in (1, 2, 3, 4)]
    places = ValueGroup([joint.cpos for joint in joints], "places")
    targets = ValueGroup([joint.pos_sp for joint in joints], "targets")
    seen: list[object] = []
    for turn in turns:
        targets.write([20 * turn, -10 * turn, 5 * turn, turn])
        link.step(0.005)
        seen.append(tuple(places.snapshot().values()))
    return seen


def of_scara(plant: str = "scara", **more: str) -> str:
    options = "".join(f"&{name}={value}" for name, value in more.items())
    return f"sim:{SCARA}?plant={plant}{options}"


@pytest.fixture(scope="module")
def halfway() -> tuple[BoardState, list[object]]:
    """A state, and what the board did from there on."""
    with connect(of_scara(), time="lockstep") as link:
        robot = load_spec_objects(load(SCARA), link)
        ValueGroup([robot[f"j{number}"].spd_sp for number in (1, 2, 3, 4)], "limits").write([9000] * 4)
        moved(link, range(20))
        return link.board.save(), moved(link, range(20, 40))


def test_another_board_goes_on_as_the_first_one(halfway: tuple[BoardState, list[object]]) -> None:
    state, went_on = halfway
    for _ in range(2):  # a state is not used up
        with connect(of_scara(), time="lockstep", state=state) as link:
            assert moved(link, range(20, 40)) == went_on
    assert len(set(map(str, went_on))) > 10


def test_the_same_calls_from_a_state_give_the_same_bytes(
    tmp_path: Path, halfway: tuple[BoardState, list[object]]
) -> None:
    runs = []
    for name in ("first", "second"):
        with connect(of_scara(trace=str(tmp_path / name)), time="lockstep", state=halfway[0]) as link:
            moved(link, range(20, 40))
        runs.append([(packet.direction, packet.data) for packet in read_packets(tmp_path / name)])
    assert runs[0] == runs[1]
    assert len(runs[0]) > 100


def test_a_native_plant_goes_on_at_its_time() -> None:
    with connect(of_scara("ramp"), time="lockstep") as link:
        link.step(0.1234)
        state = link.board.save()
        link.step(0.05)
        word = link.read(0x88)
    with connect(of_scara("ramp"), time="lockstep", state=state) as link:
        link.step(0.05)
        assert link.read(0x88) == word != 0


def test_own_plants_may_save_themselves(tmp_path: Path) -> None:
    (tmp_path / "count.ul").write_text("public count() { @count = 0x10: u32 READ(); }\n")
    url = f"sim:{tmp_path / 'count.ul'}?plant={tmp_path}"
    (tmp_path / "own.py").write_text("""
class Plant:
    period_s = 0.001
    def __init__(self):
        self.count, self.numbers = 0, (number for number in range(10**9))
    def attach(self, spec, registers):
        self.registers = registers
    def step(self, time_s):
        self.count += 1
        self.registers[0x10] = self.count
""")
    (tmp_path / "saving.py").write_text(
        (tmp_path / "own.py").read_text()
        + """
    def save(self):
        return self.count
    def restore(self, state):
        self.count = state
"""
    )
    with (
        connect(f"{url}/own.py", time="lockstep") as link,
        pytest.raises(UnityLinkError, match=r"plant Plant cannot be copied .* give it methods save"),
    ):
        link.board.save()
    with connect(f"{url}/saving.py", time="lockstep") as link:
        link.step(0.01)
        state = link.board.save()
        before = link.read(0x10)
    with connect(f"{url}/saving.py", time="lockstep", state=state) as link:
        assert link.read(0x10) == before
        link.step(0.01)
        assert link.read(0x10) == before + 10


def test_what_is_not_saved_is_told(tmp_path: Path, halfway: tuple[BoardState, list[object]]) -> None:
    other = tmp_path / "other.ul"
    other.write_text("public other() { @x = 0x10: i32 READ(); }\n")
    with pytest.raises(UnityLinkError, match="of a board with another spec"):
        connect(f"sim:{other}", time="lockstep", state=halfway[0])
    with pytest.raises(UrlError, match="hardware has its own"):
        connect("tcp://127.0.0.1:1", state=halfway[0])
    with pytest.raises(UrlError, match="compiled gateware begins at its reset"):
        connect(f"rtl:{SCARA}", time="lockstep", state=halfway[0])
    parts = Path(__file__).parents[3] / "components" / "quadrature_encoder" / "example.ul"
    with (
        connect(f"sim:{parts}", time="lockstep") as link,
        pytest.raises(UnityLinkError, match=r"state of a component is not saved yet.*quadrature_encoder"),
    ):
        link.board.save()
    queue = tmp_path / "queue.ul"
    queue.write_text(
        "public queue() { samples: samples(); }\n"
        "samples() { FIFO(BASE=0x200, DEPTH=256); @next = 0x0: i16 READCLEAR(); }\n"
    )
    with (
        connect(f"sim:{queue}", time="lockstep") as link,
        pytest.raises(UnityLinkError, match=r"samples\.next lies in a fifo"),
    ):
        link.board.save()
