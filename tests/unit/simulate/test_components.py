# SPDX-License-Identifier: BSD-3-Clause
"""Components behave on the virtual board: their words, their pins, their events and their safe state."""

from __future__ import annotations

import math
import time
from collections.abc import Callable, Iterator

import pytest

from unitylink import Link
from unitylink.errors import ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.spec import Spec, compile_text

TEXT = """
link cart (ADDRESS=8);
public cart() {
   wheel[2]: quadrature_encoder(rate=1 kHz, scale=2*pi/4096 rad);
   drive: pwm(channels=2, safe=7);
   pad: gpio(pins=4, safe=5);
   @pressed = 0x0: u4 READ(PUBLISH(on pad.changed));
}
"""


@pytest.fixture
def spec() -> Spec:
    made = compile_text(TEXT, "cart.ul").spec
    assert made is not None
    return made


@pytest.fixture
def board(spec: Spec) -> Iterator[Board]:
    with Board(spec) as made:
        yield made


def until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 10
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def address(spec: Spec, path: str) -> int:
    return dict(spec.walk())[path].address


def test_a_shaft_turns_an_encoder(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        at = address(spec, "wheel[1].position")
        assert link.read(at) == 0
        board.components["wheel[1]"].turn(1000, 0.01)
        until(lambda: link.read(at) == 1000)
        board.components["wheel[1]"].turn(-3, 0.01)
        until(lambda: link.read(at) == (-3 & 0xFFFFFFFF))
        assert link.read(address(spec, "wheel[0].position")) == 0
        assert link.read(address(spec, "wheel[1].impossible")) == 0


def test_an_index_comes_once_a_turn(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        board.components["wheel[0]"].turn(350, 0.01, per_turn=100)
        count = address(spec, "wheel[0].index_count")
        until(lambda: link.read(count) == 3)
        assert link.read(address(spec, "wheel[0].index_position")) == 300


def test_pulse_width_is_seen_at_the_pins(spec: Spec, board: Board) -> None:
    drive = board.components["drive"]
    with Link(board.url) as link:
        assert drive.duty("pins", 1) == 0
        link.write(address(spec, "drive.width[1]"), 2_000)
        link.write(address(spec, "drive.period"), 8_000)
        link.write(address(spec, "drive.control"), 1)
        until(lambda: drive.rises("pins", 1) > 50)
        drive.duty("pins", 1)
        until(lambda: drive.rises("pins", 1) > 500)
        assert drive.duty("pins", 1) == pytest.approx(0.25, rel=0.02)
        assert drive.rises("pins", 0) == 0
        until(
            lambda: (
                (pulse_s := drive.pulse_s("pins", 1)) is not None and pulse_s == pytest.approx(2_000 / 50e6)
            )
        )


def test_a_changed_pin_publishes(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        seen: list[object] = []
        robot = load_spec_objects(spec, link)
        robot["pressed"].on_publish(lambda _time, value: seen.append(value))
        link.write(address(spec, "pad.watch"), 0b0100)
        board.components["pad"].drive("pin_in", True, 2)
        until(lambda: len(seen) == 1)
        assert link.read(address(spec, "pad.levels")) == 0b0100
        board.components["pad"].drive("pin_in", True, 1)  # nobody watches it
        until(lambda: link.read(address(spec, "pad.levels")) == 0b0110)
        assert len(seen) == 1
        robot.stop_publishing()


def test_a_driven_pin_reads_its_output(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        link.write(address(spec, "pad.direction"), 0b0011)
        link.write(address(spec, "pad.set"), 0b0110)
        until(lambda: link.read(address(spec, "pad.levels")) == 0b0010)
        assert board.components["pad"].level("pin_out", 2)
        assert not board.components["pad"].level("pin_drive", 2)


def test_positions_are_published_in_radians(spec: Spec, board: Board) -> None:
    with Link(board.url) as link:
        robot = load_spec_objects(spec, link)
        seen: list[float] = []
        robot["wheel[0].position"].on_publish(lambda _time, value: seen.append(value))
        board.components["wheel[0]"].turn(1024, 0.02)
        until(lambda: bool(seen) and seen[-1] == pytest.approx(math.pi / 2))
        robot.stop_publishing()
    between = [value for value in seen if 0 < value < 1.5]
    assert between and between == sorted(between)


def test_the_dead_man_reaches_the_pins(spec: Spec) -> None:
    with Board(spec, endpoint="tcp") as board:
        pad, drive = board.components["pad"], board.components["drive"]
        link = Link(f"{board.url}?protocol=framed&deadman=0.05")
        link.write(address(spec, "pad.outputs"), 0b1010)
        link.write(address(spec, "drive.period"), 100)
        link.write(address(spec, "drive.width[0]"), 1000)
        link.write(address(spec, "drive.control"), 1)
        until(lambda: drive.level("pins", 0))
        assert [pad.level("pin_out", bit) for bit in range(4)] == [False, True, False, True]
        board.hang_up()
        until(lambda: not drive.level("pins", 0))
        assert [pad.level("pin_out", bit) for bit in range(4)] == [True, False, True, False]  # safe=5
        assert board.registers[address(spec, "drive.width[1]")] == 7
        link.close()


def test_a_plant_cannot_set_what_a_component_sets(spec: Spec, board: Board) -> None:
    with pytest.raises(ValueRangeError, match="belongs to the PC or to a component"):
        board.registers[address(spec, "wheel[0].position")] = 1


def test_mistakes_with_pins_are_told(board: Board) -> None:
    with pytest.raises(ValueRangeError, match=r"no component 'wheels'; there are wheel\[0\], wheel"):
        board.components["wheels"]
    with pytest.raises(ValueRangeError, match="drive has no output 'pin'; there are pins"):
        board.components["drive"].level("pin")
    with pytest.raises(ValueRangeError, match="drive has no input 'pins'; there are none"):
        board.components["drive"].drive("pins", True)
    with pytest.raises(ValueRangeError, match=r"drive.pins has 2 pins: choose bit 0 to 1, not 2"):
        board.components["drive"].level("pins", 2)
