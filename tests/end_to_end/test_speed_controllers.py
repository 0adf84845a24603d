# SPDX-License-Identifier: BSD-3-Clause
"""Speed controllers hear throttles and send speeds, on the twin and on the compiled VHDL alike."""

from __future__ import annotations

import math
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
link flyer (ADDRESS=8);
public flyer() {
   motor: dshot(channels=2, kbaud=100, bidirectional=1, frame_hz=500);
   pump: dshot(channels=1, kbaud=100);
}
"""

pytestmark = pytest.mark.xdist_group("rtl")


@pytest.fixture(params=[Board, pytest.param(RtlBoard, marks=pytest.mark.long)])
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    spec = compile_text(TEXT, "flyer.ul").spec
    assert spec is not None
    configuration = rtl_configuration(spec, clock_hz=2_000_000)
    with request.param(spec, configuration=configuration, endpoint="tcp") as made:
        yield made


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + 20
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_a_throttle_is_heard_and_a_speed_comes_back(board: Board) -> None:
    motor = board.components["motor"]
    left, right = motor.controller(0), motor.controller(1)
    pump = board.components["pump"].controller()
    with Link(board.url) as link:
        robot = load_spec_objects(board.spec, link)
        until(lambda: left.frames > 2 and robot["motor.reply[0]"].read().valid)
        assert (left.value, left.throttle) == (0, 0)  # the safe value is sent without a word
        assert robot["motor.speed[0]"].read() == 0

        robot["motor.throttle[1]"].write(0.5)
        robot["pump.throttle[0]"].write(1)
        until(lambda: right.throttle == 0.5)
        until(lambda: pump.value == 2047)
        assert left.throttle == 0

        for speed in (700.0, 5000.0):
            left.turn(7 * speed)
            until(lambda speed=speed: robot["motor.speed[0]"].read() == pytest.approx(speed, rel=0.01))
        left.turn(50)  # slower than the protocol can say
        until(lambda: robot["motor.speed[0]"].read() == 0)


def test_a_silent_controller_turns_its_speed_invalid(board: Board) -> None:
    esc = board.components["motor"].controller(0)
    with Link(board.url) as link:
        robot = load_spec_objects(board.spec, link)
        esc.turn(7000)
        until(lambda: robot["motor.reply[0]"].read().valid and robot["motor.speed[0]"].read() > 900)
        esc.plugged = False
        until(lambda: not robot["motor.reply[0]"].read().valid)
        reply = robot["motor.reply[0]"].read()
        assert reply.age >= 10 and reply.failures >= 10
        assert robot["motor.speed[0]"].read() == pytest.approx(1000, rel=0.01)  # old, and it says so
        esc.plugged = True
        until(lambda: robot["motor.reply[0]"].read().valid)
        assert not robot["motor.reply[1]"].read().valid  # nobody is there


def test_what_is_no_speed_and_no_channel_is_refused(board: Board) -> None:
    motor = board.components["motor"]
    with pytest.raises(ValueRangeError, match="give a finite speed"):
        motor.controller(0).turn(math.nan)
    with pytest.raises(ValueRangeError, match=r"motor.line_out has 2 pins: choose bit 0 to 1, not 2"):
        motor.controller(2)
    assert motor.controller(1) is motor.controller(1)
