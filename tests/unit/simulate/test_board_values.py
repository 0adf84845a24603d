# SPDX-License-Identifier: BSD-3-Clause
"""What a plant sees in the units of the spec."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink import connect
from unitylink.errors import UnityLinkError, ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board, BoardValues, WordPlant
from unitylink.spec import compile_text
from unitylink.spec.model import Spec

TEXT = """
enum phase: u8 { off=0; on=1; }
public arm() {
   @angle = 0x10: i16 READ(UNIT="rad", SCALE=0.001, MIN=-90 deg, MAX=90 deg);
   @mode = 0x11: phase READ();
   @clock = 0x12: u64 READ();
   @target = 0x20: i16 WRITE(UNIT="rad", SCALE=0.001);
}
"""


@pytest.fixture(scope="module")
def spec() -> Spec:
    result = compile_text(TEXT, "arm.ul")
    assert result.spec is not None, result.diagnostics
    return result.spec


def test_both_sides_see_the_same_values(spec: Spec) -> None:
    with Board(spec, plant=WordPlant()) as board, connect(board.url) as link:
        robot = load_spec_objects(spec, link)
        values = BoardValues(spec, board.registers)

        @given(st.integers(-1500, 1500), st.integers(0, 2**64 - 1))
        def same(count: int, time: int) -> None:
            values["angle"], values["clock"], values["mode"] = count / 1000, time, "on"
            assert robot["angle"].read() == pytest.approx(count / 1000)
            assert robot["clock"].read() == time
            assert robot["mode"].read() == 1

        same()
        robot["target"].write(-0.25)
        assert values["target"] == pytest.approx(-0.25)
        values["angle"] = 7
        assert values["angle"] == pytest.approx(1.571, abs=0.001)  # a sensor stops at its limit


def test_mistakes_are_told_with_the_name(spec: Spec) -> None:
    with Board(spec) as board:
        values = BoardValues(spec, board.registers)
        with pytest.raises(UnityLinkError, match="did you mean 'angle'"):
            values["angel"] = 1
        with pytest.raises(ValueRangeError, match="angle: 'up' is not a number"):
            values["angle"] = "up"
        with pytest.raises(UnityLinkError, match="there are none"):
            BoardValues(None, board.registers)["angle"]
