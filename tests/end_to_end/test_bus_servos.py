# SPDX-License-Identifier: BSD-3-Clause
"""Servos on a bus take goals and give positions, on the twin and on the compiled VHDL alike."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import pytest

from unitylink import Link
from unitylink.errors import ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.simulate.rtl.board import rtl_configuration
from unitylink.spec import compile_text

TEXT = """
link arm (ADDRESS=8);
public arm() {
   x: servo_bus(servos=2, baud_hz=200000, cycle_hz=100, timeout_us=300, scale=1/1024 rad);
   sts: servo_bus(servos=2, protocol=1, first_id=7, baud_hz=200000, cycle_hz=100, timeout_us=300);
}
"""
KINDS = ("x", "sts")

pytestmark = pytest.mark.xdist_group("rtl")


@pytest.fixture(params=[Board, pytest.param(RtlBoard, marks=pytest.mark.long)])
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    spec = compile_text(TEXT, "arm.ul").spec
    assert spec is not None
    configuration = rtl_configuration(spec, clock_hz=2_000_000)
    with request.param(spec, configuration=configuration, endpoint="tcp") as made:
        yield made


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + 30
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_servos_follow_hold_and_let_go(board: Board) -> None:
    for kind in KINDS:
        servos = [board.components[kind].servo(number) for number in range(2)]
        for number, servo in enumerate(servos):
            servo.tell(position=-300 + 1000 * number, speed=-7, load=-100)
        with Link(f"{board.url}?timeout=20") as link:
            robot = load_spec_objects(board.spec, link)
            scale = 1 / 1024 if kind == "x" else 1
            until(lambda: all(robot[f"{kind}.status[{n}]"].read().valid for n in range(2)))  # noqa: B023
            for number, position in ((0, -300 * scale), (1, 700 * scale)):
                until(lambda: robot[f"{kind}.position[{number}]"].read() == position)  # noqa: B023
            assert robot[f"{kind}.speed[0]"].read() == pytest.approx(-7 * scale)
            assert robot[f"{kind}.load[1]"].read() == -100
            assert not servos[0].torque

            robot[f"{kind}.goal[0]"].write(-512 * scale)
            robot[f"{kind}.drive[0]"].write("follow")
            robot[f"{kind}.drive[1]"].write("hold")
            until(lambda: servos[0].torque and servos[1].torque)  # noqa: B023
            until(lambda: servos[0].goal == -512)  # noqa: B023
            until(lambda: servos[1].goal == 700)  # noqa: B023
            robot[f"{kind}.drive[0]"].write("off")
            until(lambda: not servos[0].torque)  # noqa: B023
            assert servos[1].torque
            assert robot[f"{kind}.lasted"].read() > 1000


def test_a_servo_that_is_gone_turns_invalid_and_the_other_goes_on(board: Board) -> None:
    first, second = (board.components["x"].servo(number) for number in range(2))
    with Link(f"{board.url}?timeout=20") as link:
        robot = load_spec_objects(board.spec, link)
        first.tell(position=1024)
        until(lambda: robot["x.position[0]"].read() == 1.0)
        first.plugged = False
        until(lambda: not robot["x.status[0]"].read().valid)
        assert robot["x.status[0]"].read().failure.name == "no_answer"
        assert robot["x.failures[0]"].read() >= 3
        assert robot["x.position[0]"].read() == 1.0  # the last one, and it says that it is old
        assert robot["x.age[0]"].read() == 0xFFFFF
        second.tell(position=512, alarm=0x80)
        until(lambda: robot["x.position[1]"].read() == 0.5)
        assert robot["x.status[1]"].read().alarm == 0x80
        assert robot["x.age[1]"].read() < 30_000
        first.plugged = True
        until(lambda: robot["x.status[0]"].read().valid)


def test_what_a_servo_cannot_have_is_refused(board: Board) -> None:
    with pytest.raises(ValueRangeError, match="x has 2 servos: choose 0 to 1, not 2"):
        board.components["x"].servo(2)
    with pytest.raises(ValueRangeError, match="the load of a servo is -1023 to 1023, not 2000"):
        board.components["sts"].servo(0).tell(0, load=2000)
    assert board.components["x"].servo(1) is board.components["x"].servo(1)
