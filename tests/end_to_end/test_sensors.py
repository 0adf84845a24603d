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


@boards
def test_a_load_is_weighed(kind: Any) -> None:
    line = "plate: hx711(settle=2, timeout=20 ms, scale=1/1000 kg, rate=200 Hz);"
    with robot(kind, line, clock_hz=8_000_000) as (board, objects):
        cell = board.components["plate"].load_cell(conversions_hz=1000)
        cell.weigh(-1_234_567)
        cell.weigh(5_000, input=1)
        until(lambda: objects["plate.state"].read().valid)
        assert objects["plate.value"].read() == pytest.approx(-1234.567)
        seen: list[float] = []
        objects["plate.value"].on_publish(lambda _time, value: seen.append(value))
        cell.weigh(42_000)
        until(lambda: seen and seen[-1] == pytest.approx(42))
        objects.stop_publishing()
        control = objects["plate.control"]
        control.write({"enable": True, "input": "b_32"})
        until(lambda: objects["plate.state"].read().valid)
        assert objects["plate.value"].read() == pytest.approx(5)
        cell.weigh(1 << 30, input=1)
        until(lambda: objects["plate.state"].read().failure.name == "out_of_range")
        cell.plugged = False
        until(lambda: objects["plate.state"].read().failure.name in ("no_answer", "stuck"))
        until(lambda: not objects["plate.state"].read().valid)
        cell.weigh(7_000, input=1)
        cell.plugged = True
        until(lambda: objects["plate.state"].read().valid)
        assert objects["plate.value"].read() == pytest.approx(7)
        assert cell.conversions_hz == pytest.approx(1000)
        with pytest.raises(ValueRangeError, match="inputs 0 to 2, not 3"):
            cell.weigh(0, input=3)
        with pytest.raises(ValueRangeError, match=r"give 0\.1 to 10000"):
            cell.conversions_hz = 0


@boards
def test_a_strip_shows_its_colours_and_goes_dark(kind: Any) -> None:
    line = "ring: ws2812(leds=3, safe=0); lamp: sk6812_rgbw(leds=1);"
    with robot(kind, line, clock_hz=8_000_000) as (board, objects):
        ring, lamp = (board.components[name].led_strip() for name in ("ring", "lamp"))
        assert ring.colours == [(0, 0, 0)] * 3
        until(lambda: not objects["ring.busy"].read())
        colours = [(255, 1, 2), (3, 128, 4), (5, 6, 200)]
        for number, (red, green, blue) in enumerate(colours):
            objects[f"ring.colour[{number}]"].write({"red": red, "green": green, "blue": blue})
        objects["lamp.colour[0]"].write({"red": 9, "green": 8, "blue": 7, "white": 100})
        for name in ("ring", "lamp"):
            objects[f"{name}.control"].write({"on": True})
        until(lambda: ring.colours == colours and lamp.colours == [(9, 8, 7, 100)])
        objects["ring.colour[1]"].write({"red": 0, "green": 0, "blue": 99})
        objects["ring.update"].pulse(1)
        colours[1] = (0, 0, 99)
        until(lambda: ring.colours == colours)
        objects["ring.control"].write({"on": False})
        until(lambda: ring.colours == [(0, 0, 0)] * 3)
        assert lamp.colours == [(9, 8, 7, 100)]
        assert objects["ring.colour[1]"].read().blue == 99
        with pytest.raises(ValueRangeError, match="has no output 'data'"):
            board.components["other"].led_strip()


@boards
def test_a_temperature_is_read_and_a_false_one_is_not(kind: Any) -> None:
    line = "motor: one_wire(period=115 ms, resolution=9, rate=20 Hz);"
    with robot(kind, line, clock_hz=1_000_000) as (board, objects):
        motor = board.components["motor"].thermometer()
        motor.warm(-10.5)
        until(lambda: objects["motor.state"].read().valid)
        assert objects["motor.temperature"].read() == pytest.approx(-10.5)
        motor.warm(85.0)
        until(lambda: objects["motor.temperature"].read() == pytest.approx(85))
        assert objects["motor.state"].read().failure.name == "none"
        motor.warm(30.0)
        until(lambda: objects["motor.temperature"].read() == pytest.approx(30))
        failures = objects["motor.state"].read().failures

        def fails_restarted() -> bool:  # again and again: a restart between two tries does no harm
            motor.restart()
            return bool(objects["motor.state"].read().failures != failures)

        until(fails_restarted)
        assert objects["motor.temperature"].read() == pytest.approx(30)  # not 85
        motor.plugged = False
        until(lambda: objects["motor.state"].read().failure.name == "no_answer")
        until(lambda: not objects["motor.state"].read().valid)
        motor.warm(12.0)
        motor.plugged = True
        until(lambda: objects["motor.state"].read().valid)
        assert objects["motor.temperature"].read() == pytest.approx(12)
        with pytest.raises(ValueRangeError, match="give -55 to 125 degC"):
            motor.warm(126)
        with pytest.raises(ValueRangeError, match=r"give 0\.001 to 10 s"):
            motor.conversion_s = 0
