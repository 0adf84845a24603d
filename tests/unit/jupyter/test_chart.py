# SPDX-License-Identifier: BSD-3-Clause
"""The live chart: what Python sends, what the browser makes of it, and how it ends."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import quickjs
from unit.dashboard.robot import Still, compiled

import unitylink.jupyter
from unitylink import Link, connect
from unitylink.errors import ToolError, ValueRangeError
from unitylink.jupyter.chart import POINTS, Chart, thinned
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board, BoardConfiguration

SCRIPT = Path(unitylink.jupyter.__file__).parent / "chart.js"
LIMIT_S = 10.0


class Arm:
    """A robot on which nothing moves, and the messages of its charts."""

    def __init__(self, board: Board, link: Link, robot: Any) -> None:
        self.board, self.link, self.robot = board, link, robot
        self.messages: list[np.ndarray[Any, np.dtype[np.float64]]] = []

    def live(self, *values: Any, **options: Any) -> Chart:
        chart = unitylink.jupyter.live(*values, **options)
        chart.send = lambda content, buffers: self.messages.append(np.frombuffer(buffers[0], "<f8"))  # type: ignore[method-assign]
        return chart

    def values(self, number: int) -> list[float]:
        """Return all values of one series that were sent."""
        found: list[float] = []
        for message in list(self.messages):
            at = 0
            while at < len(message):
                which, count = int(message[at]), int(message[at + 1])
                if which == number:
                    found += message[at + 2 + count : at + 2 + 2 * count].tolist()
                at += 2 + 2 * count
        return found


@pytest.fixture
def arm() -> Iterator[Arm]:
    spec = compiled()
    configuration = BoardConfiguration.for_spec(spec)
    with (
        Board(spec, configuration=configuration, plant=Still()) as board,
        connect(f"{board.url}?timeout=2") as link,
    ):
        yield Arm(board, link, load_spec_objects(spec, link))


def until(done: Callable[[], Any]) -> None:
    end_s = time.monotonic() + LIMIT_S
    while not done():
        assert time.monotonic() < end_s
        time.sleep(0.01)


def test_published_and_polled_values_come_with_their_units(arm: Arm) -> None:
    arm.board.registers[0x11], arm.board.registers[0x20], arm.board.registers[0x30] = 123, 7, 1
    chart = arm.live(arm.robot.j1.angle, arm.robot.j2.speed, rate_hz=50)
    assert chart.series == [
        {"name": "j1.angle", "unit": "deg", "members": {}},
        {"name": "j2.speed", "unit": "", "members": {}},
    ]
    until(lambda: 12.3 in arm.values(0) and 7 in arm.values(1))
    arm.board.registers[0x11] = 200
    until(lambda: 20.0 in arm.values(0))
    chart.close()


def test_parts_groups_and_arrays_are_drawn_without_what_is_no_number(arm: Arm) -> None:
    chart = arm.live(arm.robot, (arm.robot.j1, arm.robot.j2))
    assert [one["name"] for one in chart.series] == ["j1.angle", "j1.speed", "j2.angle", "j2.speed", "wide"]
    chart.close()


@pytest.mark.parametrize("path", ["faults", "j1.target", "reset"])
def test_what_cannot_be_drawn_is_named(arm: Arm, path: str) -> None:
    with pytest.raises(ValueRangeError, match=path):
        arm.live(arm.robot[path])


@pytest.mark.parametrize(
    ("values", "options", "text"),
    [((), {}, "1 to 16"), ((3,), {}, "3 is no value"), (("j1",), {"window_s": 0}, "window_s 0")],
)
def test_wrong_arguments(arm: Arm, values: Any, options: dict[str, Any], text: str) -> None:
    with pytest.raises(ValueRangeError, match=text):
        arm.live(*(arm.robot[one] if isinstance(one, str) else one for one in values), **options)


def test_a_wrong_rate_leaves_nothing_behind(arm: Arm) -> None:
    angle, speed = arm.robot.j1.angle, arm.robot.j1.speed
    with pytest.raises(ValueRangeError, match="rate_hz"):
        arm.live(angle, speed, rate_hz=-1)
    assert not angle.listeners.heard and not speed.listeners.heard


def test_a_closed_chart_hears_nothing_and_others_go_on(arm: Arm) -> None:
    angle, came = arm.robot.j1.angle, []
    angle.on_publish(lambda _, value: came.append(value))
    chart = arm.live(angle)
    until(lambda: arm.values(0))
    chart.close()
    sent, heard = len(arm.messages), len(came)
    until(lambda: len(came) > heard + 20)
    assert len(arm.messages) <= sent + 1


def test_a_link_that_ends_is_said(arm: Arm) -> None:
    chart = arm.live(arm.robot.j1.angle)
    arm.link.close()
    until(lambda: chart.ended == "the link has ended")
    chart.close()


@pytest.mark.parametrize("count", [1, POINTS, POINTS + 1, 777, 10_000])
def test_no_peak_is_lost(count: int) -> None:
    random = np.random.default_rng(count)
    samples = np.stack((np.sort(random.uniform(0, 1, count)), random.normal(size=count)))
    few = thinned(samples)
    assert few.shape[1] <= POINTS
    assert few[1].min() == samples[1].min() and few[1].max() == samples[1].max()
    assert {tuple(pair) for pair in few.T} <= {tuple(pair) for pair in samples.T}
    assert (np.diff(few[0]) >= 0).all()


def test_without_anywidget_the_remedy_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "anywidget", None)
    with pytest.raises(ToolError, match=r"a live chart needs the package anywidget: .* install .anywidget"):
        unitylink.jupyter.live()


# The side of the browser


@pytest.fixture(scope="module")
def script() -> quickjs.Context:
    context = quickjs.Context()
    text = SCRIPT.read_text("utf-8").replace("export default", "globalThis.made =").replace("export ", "")
    context.eval(text)
    return context


def run(script: quickjs.Context, expression: str, **facts: Any) -> Any:
    for name, fact in facts.items():
        script.eval(f"globalThis.{name} = {json.dumps(fact)}")
    return json.loads(script.eval(f"JSON.stringify({expression})"))


@pytest.mark.parametrize("seed", range(4))
def test_columns_have_every_sample_and_hold_values(script: quickjs.Context, seed: int) -> None:
    random = np.random.default_rng(seed)
    times = np.sort(random.uniform(-2, 10, 300 if seed else 9)).round(6)
    values = random.normal(size=len(times)).round(6)
    message = [0, len(times), *times.tolist(), *values.tolist()]
    script.eval("globalThis.all = [new Series()]")
    assert run(script, "take(all, message, 1000)", message=message) == times[-1]
    count, step = 40, 10 / 40
    spans = run(script, f"columns(all[0], 0, {step}, {count})")
    numbers = np.floor(times / step).astype(int)
    for column in range(count):
        inside = values[numbers == column].tolist()
        before = values[numbers < column].tolist()[-1:]
        if column > numbers[-1]:
            assert spans[column] is None
        elif inside or before:
            edges = inside + before
            assert spans[column] == [min(edges), max(edges)]
        else:
            assert spans[column] is None


def test_old_samples_are_forgotten_and_a_restart_begins_anew(script: quickjs.Context) -> None:
    script.eval("globalThis.all = [new Series()]")
    for begin in range(0, 1000, 50):
        times = list(range(begin, begin + 50))
        run(script, "take(all, message, 100)", message=[0, 50, *times, *times])
    kept = run(script, "all[0].times")
    assert 100 <= len(kept) <= 200 and kept[-1] == 999 and kept[0] <= 899
    run(script, "take(all, message, 100)", message=[0, 1, 3.0, 4.0])
    assert run(script, "all[0].times") == [3.0]


def test_texts_have_units_and_names_of_members(script: quickjs.Context) -> None:
    facts = {"name": "a", "unit": "deg", "members": {}}
    assert run(script, "shown(facts, 12.300000000001)", facts=facts) == "12.3 deg"
    assert run(script, "shown(facts, 1)", facts={"name": "a", "unit": "", "members": {"1": "hold"}}) == "hold"


def test_infinities_are_left_out(script: quickjs.Context) -> None:
    script.eval("globalThis.all = [new Series()]; all[0].add([0, 1, 2], [1, NaN, Infinity], -1)")
    assert run(script, "columns(all[0], 0, 1, 3)") == [[1, 1], None, None]
    assert not math.isfinite(float(script.eval("take(all, [], 1)")))
