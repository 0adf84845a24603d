# SPDX-License-Identifier: BSD-3-Clause
"""Publishing on events and on change, and initial values, on a board made from a spec."""

from __future__ import annotations

import threading
from typing import Any

import pytest

from unitylink import Link
from unitylink.errors import ValueRangeError
from unitylink.layer4_data import ReadValue, load_spec_objects
from unitylink.simulate import Board, BoardConfiguration, RampPlant
from unitylink.simulate.registers import Registers
from unitylink.spec import Spec, compile_text

TEXT = """
enum mode: u2 { idle = 0; run = 1; stop = 2; }
public arm() {
   @hit = 0x10: READ(PUBLISH(on limit));
   @door = 0x11: bool READ(PUBLISH(on change));
   @force = 0x12: i32 READ(SCALE=0.5, UNIT="N", PUBLISH(on change));
   @pos = 0x13: i16 READ(PUBLISH(100 Hz));
   @gain = 0x14: f64 READWRITE(INITIAL=-2.5);
   @mode = 0x16: mode READWRITE(INITIAL=stop);
   @state = 0x17: mode READ();
   @nibble = 0x18: u4 READ();
}
"""


class Still:
    """A plant in which nothing moves. Its steps let the board notice changes."""

    period_s = 0.001

    def attach(self, spec: Spec | None, registers: Registers) -> None:
        pass

    def step(self, time_s: float) -> None:
        pass


@pytest.fixture(scope="module")
def spec() -> Spec:
    result = compile_text(TEXT, "arm.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


def test_events_and_changes_publish(spec: Spec) -> None:
    with Board(spec, plant=Still()) as board, Link(f"{board.url}?timeout=10") as link:
        arm = load_spec_objects(spec, link)
        hit, force = arm["hit"], arm["force"]
        assert isinstance(hit, ReadValue) and isinstance(force, ReadValue)
        came: list[Any] = []
        arrived = threading.Semaphore(0)

        def note(value: Any) -> None:
            came.append(value)
            arrived.release()

        force.on_publish(lambda _, value: note(("force", value)))
        assert arrived.acquire(timeout=10) and came == [("force", 0.0)], "what it is before it changes"
        hit.on_publish(lambda _, value: note(("hit", value)))
        board.registers[0x10] = 7
        board.event("limit")
        assert arrived.acquire(timeout=10) and came[1] == ("hit", 7)
        board.registers[0x12] = -3
        assert arrived.acquire(timeout=10) and came[2] == ("force", -1.5)
        with pytest.raises(ValueRangeError, match="no group is published on 'alarm'; there are limit"):
            board.event("alarm")


def test_a_counting_plant_changes_too(spec: Spec) -> None:
    with Board(spec, plant=RampPlant()) as board, Link(f"{board.url}?timeout=10") as link:
        arm = load_spec_objects(spec, link)
        force = arm["force"]
        assert isinstance(force, ReadValue)
        twice = threading.Semaphore(0)
        force.on_change(lambda _: twice.release())
        assert twice.acquire(timeout=10) and twice.acquire(timeout=10)
        for _ in range(50):  # every value that it counts through is valid for its type
            arm.snapshot()


def test_words_begin_as_the_spec_says(spec: Spec) -> None:
    with Board(spec) as board, Link(f"{board.url}?timeout=10") as link:
        arm = load_spec_objects(spec, link)
        gain, mode = arm["gain"], arm["mode"]
        assert isinstance(gain, ReadValue) and isinstance(mode, ReadValue)
        assert gain.read() == -2.5 and mode.read().name == "stop"


def test_the_board_has_the_settings_of_the_spec_s_link() -> None:
    text = "link lab.a (DATA=16, ADDRESS=16, BASE_RATE=500 Hz);\n"
    text += "public a() { @x = 0x10: u32 READ(PUBLISH(50 Hz)); }"
    spec = compile_text(text, "a.ul").spec
    assert spec is not None
    configuration = BoardConfiguration.for_spec(spec)
    assert (configuration.data_bits, configuration.address_bits, configuration.base_hz) == (16, 16, 500)
    with Board(spec, plant=Still()) as board, Link(f"{board.url}?timeout=10") as link:
        board.registers[0x10], board.registers[0x11] = 0x2345, 1
        x = load_spec_objects(spec, link)["x"]
        assert isinstance(x, ReadValue) and x.read() == 0x12345
