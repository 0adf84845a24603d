# SPDX-License-Identifier: BSD-3-Clause
"""Sensors with lines of their own, through the public API, on the twin and on the compiled VHDL alike."""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import contextmanager
from typing import Any

import pytest

from unitylink import Link
from unitylink.errors import ValueRangeError
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board
from unitylink.simulate.rtl import RtlBoard
from unitylink.simulate.rtl.board import rtl_configuration
from unitylink.spec import compile_text

pytestmark = pytest.mark.xdist_group("rtl")
boards = pytest.mark.parametrize("kind", [Board, RtlBoard])


@contextmanager
def robot(kind: Any, line: str, clock_hz: int = 4_000_000) -> Any:
    """Yield a board with one component, and the objects of its spec."""
    spec = compile_text(f"link r(ADDRESS=8); public r() {{ {line} other: gpio(pins=1); }}", "r.ul").spec
    assert spec is not None
    configuration = rtl_configuration(spec, clock_hz=clock_hz)
    with (
        kind(spec, configuration=configuration, endpoint="tcp") as board,
        Link(board.url) as link,
    ):
        yield board, load_spec_objects(spec, link)


def until(true: Callable[[], object]) -> None:
    end = time.monotonic() + 30
    while not true():
        assert time.monotonic() < end
        time.sleep(0.002)


@boards
def test_a_distance_is_measured(kind: Any) -> None:
    with robot(kind, "front: sonar(period=8 ms, timeout=6 ms, rate=200 Hz);") as (board, objects):
        sensor = board.components["front"].distance_sensor()
        sensor.see(0.75)
        until(lambda: objects["front.state"].read().valid)
        assert objects["front.distance"].read() == pytest.approx(750, abs=0.4)
        seen: list[float] = []
        objects["front.distance"].on_publish(lambda _time, value: seen.append(value))
        sensor.see(0.1)
        until(lambda: seen and seen[-1] == pytest.approx(100, abs=0.4))
        objects.stop_publishing()
        sensor.see(None)
        until(lambda: objects["front.state"].read().failure.name == "stuck")
        until(lambda: not objects["front.state"].read().valid)
        sensor.plugged = False
        until(lambda: objects["front.state"].read().failure.name == "no_answer")
        assert objects["front.distance"].read() == pytest.approx(100, abs=0.4)
        sensor.see(0.2)
        sensor.plugged = True
        until(lambda: objects["front.state"].read().valid)
        assert objects["front.distance"].read() == pytest.approx(200, abs=0.4)
        shortest_s = sensor.shortest_s
        assert shortest_s["trigger"] >= 10e-6
        assert shortest_s["cycle"] >= 7.9e-3
        assert board.components["front"].distance_sensor() is sensor
        with pytest.raises(ValueRangeError, match="at most 30 m"):
            sensor.see(31)
        with pytest.raises(ValueRangeError, match="has no output 'trigger'"):
            board.components["other"].distance_sensor()
