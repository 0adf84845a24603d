# SPDX-License-Identifier: BSD-3-Clause
"""A pilot drives by a remote control, on the twin and on the compiled VHDL alike: failsafe, silence."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import pytest

from unitylink import Link
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.simulate.rtl.board import rtl_configuration
from unitylink.spec import compile_text

TEXT = """
link rover (ADDRESS=8);
public rover() {
   pilot: rc_receiver(channels=8, scale=1/4000, offset=-3, lost_us=1500, timeout_ms=1000);
   copter: rc_receiver(protocol=0, channels=4, inverted=0, timeout_ms=1000);
}
"""

pytestmark = pytest.mark.xdist_group("rtl")


@pytest.fixture(params=[Board, pytest.param(RtlBoard, marks=pytest.mark.long)])
def board(request: pytest.FixtureRequest) -> Iterator[Board]:
    spec = compile_text(TEXT, "rover.ul").spec
    assert spec is not None
    configuration = rtl_configuration(spec, clock_hz=8_000_000)
    with request.param(spec, configuration=configuration, endpoint="tcp") as made:
        yield made


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + 30
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def test_a_pilot_is_heard_and_lost(board: Board) -> None:
    with Link(board.url) as link:
        robot = load_spec_objects(board.spec, link)
        state = robot["pilot.state"].read
        radio = board.components["pilot"].radio()
        assert not state().valid and robot["pilot.channel[0]"].read() == 0.0
        radio.silence(5e-3)
        radio.send([1000.0, 2000.0, 1750.0], switches=2)
        until(lambda: robot["pilot.frames"].read() == 1)
        assert [robot[f"pilot.channel[{n}]"].read() for n in range(4)] == [-1.0, 1.0, 0.5, 0.0]
        assert (state().valid, state().switches) == (True, 2)

        radio.send([1500.0], lost=True)
        until(lambda: state().lost)
        assert robot["pilot.channel[0]"].read() == -1.0
        radio.send([2000.0], failsafe=True)
        until(lambda: state().failsafe)
        assert not state().valid and robot["pilot.channel[0]"].read() == 0.0
        assert robot["pilot.age"].read() == 1_048_575
        radio.send([2000.0])
        until(lambda: state().valid)
        assert robot["pilot.channel[0]"].read() == 1.0
        until(lambda: not state().valid)  # silence
        assert (robot["pilot.frames"].read(), robot["pilot.repeats"].read()) == (2, 1)
        assert robot["pilot.broken"].read() == 0


def test_pulses_are_channels(board: Board) -> None:
    with Link(board.url) as link:
        robot = load_spec_objects(board.spec, link)
        radio = board.components["copter"].radio()
        radio.silence(5e-3)
        radio.send([1000.0, 1250.0, 1500.0, 2000.0])
        until(lambda: robot["copter.state"].read().valid)
        got = [robot[f"copter.channel[{n}]"].read() for n in range(4)]
        assert got == pytest.approx([1000.0, 1250.0, 1500.0, 2000.0], abs=0.5)  # us
        radio.send([1000.0, 1250.0, 1500.0])
        until(lambda: robot["copter.broken"].read() == 1)
        assert robot["copter.frames"].read() == 1
