# SPDX-License-Identifier: BSD-3-Clause
"""Models run no clock while nothing happens, and nobody can tell that from outside."""

from __future__ import annotations

import random
import time
from pathlib import Path

import pytest

from unitylink import _native, connect
from unitylink.interface.components import components_of
from unitylink.spec import compile_text

CONTROL, TARGET, SPEED, ACCELERATION, LATCHED, STAMP = 0, 1, 2, 3, 8, 9
ENABLE_AND_LATCH_HOME = 0b11001
REST = 400_000  # clocks: several cycles of base periods and ramps

Stimuli = list[tuple[int, str, int, int]]


def stimuli(axes: int, draw: random.Random) -> tuple[Stimuli, int]:
    """Let axis 0 go somewhere, rest, be looked at, latch, and go back; the end is the second value."""
    found: Stimuli = []
    clock = 1000
    writes = ((SPEED, 20_000 * 256), (ACCELERATION, 8000), (CONTROL, ENABLE_AND_LATCH_HOME), (TARGET, 7))
    for word, value in writes:
        found.append((clock, "w", word, value))
        clock += 1000
    for number in range(3):
        clock += REST + draw.randrange(5000)
        found += [(clock + 200 * word, "r", word, 0) for word in range(11)]
        clock += 3000
        home = 2 * axes
        found += [(clock, "p", home, 1), (clock + 900, "p", home, 0)]
        clock += REST + draw.randrange(5000)
        found += [(clock, "r", LATCHED, 0), (clock + 200, "r", STAMP, 0)]
        found += [(clock + 400, "w", CONTROL, ENABLE_AND_LATCH_HOME), (clock + 600, "w", TARGET, 3 * number)]
    return found, clock + REST


@pytest.mark.parametrize(("axes", "clock_hz"), [(1, 8_000_000), (3, 20_000_000), (4, 1 << 25)])
def test_a_rest_that_is_not_run_is_as_one_that_is(axes: int, clock_hz: int) -> None:
    text = f"link l(ADDRESS=8); public a() {{ m: stepgen(axes={axes}, stable_clocks=4); }}"
    spec = compile_text(text).spec
    assert spec is not None
    (one,) = components_of(spec, clock_hz)
    told, end = stimuli(axes, random.Random(axes))
    stop = 3 * axes
    # an input that is high for one clock goes nowhere, but the model cannot rest meanwhile
    glitches = [(at + late, "p", stop, 1 - late) for at in range(500, end, 4000) for late in (0, 1)]
    run = sorted([*told, *glitches], key=lambda change: change[0])
    seen = _native.ComponentModel(one).play(told, end)
    assert seen == _native.ComponentModel(one).play(run, end)
    answers = [value for _, what, _, value in seen if what == "a"]
    assert any(answers) and len([one for one in seen if one[1] == "o"]) > 10, "it has moved"


def test_an_axis_that_rests_for_an_hour_costs_nothing(tmp_path: Path) -> None:
    file = tmp_path / "stage.ul"
    file.write_text("link stage (ADDRESS=8);\npublic stage() {\n   motor: stepgen();\n}\n", encoding="utf-8")
    with connect(f"sim:{file}", time="lockstep") as link:
        link.write(SPEED, 20_000 * 256)
        link.write(ACCELERATION, 8000)
        link.write(TARGET, 100)
        link.write(CONTROL, 1)
        link.step(3600.0)
        busy_s = time.process_time()
        assert link.read(5) == 100, "it has gone there meanwhile"
        assert time.process_time() - busy_s < 1.0


def test_a_device_that_does_not_answer_costs_nothing_while_it_is_awaited(tmp_path: Path) -> None:
    file = tmp_path / "well.ul"
    text = "link well (ADDRESS=8);\npublic well() {\n   meter: modbus_master();\n}\n"
    file.write_text(text, encoding="utf-8")
    with connect(f"sim:{file}?timeout=30", time="lockstep") as link:
        link.step(60.0)
        busy_s = time.process_time()
        assert link.read(2) > 100, "it has failed so often"
        assert time.process_time() - busy_s < 1.0
