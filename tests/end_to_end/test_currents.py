# SPDX-License-Identifier: BSD-3-Clause
"""What a plant lets modulators measure is read in ampere, on the twin and on the compiled VHDL alike."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import pytest

from unitylink import connect
from unitylink.errors import ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.spec import compile_text

TEXT = """
link joint (ADDRESS=8);
public joint() {
   current: sigma_delta_adc(channels=2, full_scale=32 A);
   stop: estop();
}
"""

pytestmark = pytest.mark.xdist_group("rtl")


def until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 20
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


@pytest.mark.parametrize("kind", [Board, RtlBoard])
def test_currents_are_measured_and_trip(kind: type[Board]) -> None:
    spec = compile_text(TEXT, "joint.ul").spec
    assert spec is not None
    with kind(spec, endpoint="tcp") as board:
        outside = board.components["current"]
        outside.modulate(0.25, channel=0)
        outside.modulate(-0.5, seconds=0.001, channel=1)
        with connect(board.url) as link:
            item: Any = load_spec_objects(spec, link)
            until(lambda: abs(item["current.value[0]"].read() - 8.0) < 0.1)
            until(lambda: abs(item["current.value[1]"].read() + 16.0) < 0.1)
            item["current.limit"].write(24.0)
            item["current.control"].write({"enable": True})
            assert item["current.status"].read().running
            outside.modulate(0.9, channel=0)  # 28.8 A
            until(lambda: item["current.status"].read().tripped)
            assert item["current.status"].read().culprits == 1 and outside.level("trip")
            outside.modulate(0.25, channel=0)
            outside.drive("data", True, 1)  # a broken line
            until(lambda: item["current.status"].read().lost)
            outside.modulate(-0.5, channel=1)
            until(lambda: not item["current.status"].read().lost)
            until(lambda: abs(item["current.value[1]"].read() + 16.0) < 0.1)


def test_mistakes_with_modulators_are_told() -> None:
    spec = compile_text(TEXT, "joint.ul").spec
    with Board(spec, endpoint="tcp") as board:
        with pytest.raises(ValueRangeError, match="cannot have the input nan: give a share from -1 to 1"):
            board.components["current"].modulate(math.nan)
        with pytest.raises(ValueRangeError, match="has 2 pins: choose bit 0 to 1, not 2"):
            board.components["current"].modulate(0.0, channel=2)
        with pytest.raises(ValueRangeError, match="has no output 'mclk'"):
            board.components["stop"].modulate(0.0)
