# SPDX-License-Identifier: BSD-3-Clause
"""Hall sensors on the twin and on the compiled VHDL: a rotor turns by hand, and a line breaks."""

from __future__ import annotations

import math
import time
from collections.abc import Callable
from typing import Any

import pytest

from unitylink import connect
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.components import BoardComponent
from unitylink.simulate.rtl import RtlBoard
from unitylink.spec import compile_text

TEXT = """
link joint (ADDRESS=8);
public joint() {
   rotor: hall(scale=2*pi/42 rad, with_velocity=1, stall_us=500000);
}
"""
CODES = ((1, 0, 1), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 1, 1), (0, 0, 1))  # of the sectors, line 0 first

pytestmark = pytest.mark.xdist_group("rtl")


def until(true: Callable[[], bool]) -> None:
    end = time.monotonic() + 20
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


def show(rotor: BoardComponent, code: tuple[int, int, int]) -> None:
    for line, level in enumerate(code):
        rotor.drive("lines", level, line)


@pytest.mark.parametrize("kind", [Board, RtlBoard])
def test_a_rotor_is_followed_and_a_broken_line_is_told(kind: type[Board]) -> None:
    spec = compile_text(TEXT, "joint.ul").spec
    assert spec is not None
    with kind(spec, endpoint="tcp") as board, connect(board.url) as link:
        item: Any = load_spec_objects(spec, link)
        rotor = board.components["rotor"]
        show(rotor, CODES[0])
        until(lambda: item["rotor.status"].read().valid and item["rotor.status"].read().sector == 0)
        start = item["rotor.position"].read()  # the lines rise one after the other
        failures = item["rotor.failures"].read()  # that of lines that were all low
        for sector in (*range(1, 6), 0, 1):
            show(rotor, CODES[sector])
            until(lambda expected=sector: item["rotor.status"].read().sector == expected)
        assert math.isclose(item["rotor.position"].read() - start, 7 * 2 * math.pi / 42)
        assert math.pi / 3 <= item["rotor.angle"].read() <= 2 * math.pi / 3
        until(lambda: item["rotor.velocity"].read() > 0.0)
        show(rotor, CODES[0])
        until(lambda: item["rotor.status"].read().backward)
        assert math.isclose(item["rotor.position"].read() - start, 6 * 2 * math.pi / 42)
        show(rotor, (0, 0, 0))
        until(lambda: not item["rotor.status"].read().valid)
        assert item["rotor.failures"].read() == failures + 1
