# SPDX-License-Identifier: BSD-3-Clause
"""What a plot draws: numbers with their units, members of enumerations, fields of packed values."""

from __future__ import annotations

from unitylink.commands.series import AllSeries, Series, parts_of
from unitylink.spec import compile_text

SPEC = """
enum mode: u2 { idle = 0; run = 1; stop = 3; }
bits status: u8 { ready: bool @ 0; mode: mode @ 2..1; current: u4 @ 7..4 (UNIT="A", SCALE=0.1); }
public arm() {
   @status = 0x1: status READ();
   @angle = 0x2: i16 READ(UNIT="rad", SCALE=0.01);
   @mode = 0x3: mode READ();
}
"""


def declared() -> AllSeries:
    spec = compile_text(SPEC).spec
    assert spec is not None
    series = AllSeries()
    for path, element in spec.walk():
        series.declare(parts_of(path, element.type, element.unit))
    return series


def test_each_has_its_unit_and_each_enumeration_its_members_in_order() -> None:
    known = {path: (one.unit, one.members) for path, one in declared().items()}
    assert known == {
        "status.ready": ("", []),
        "status.mode": ("", ["idle", "run", "stop"]),
        "status.current": ("A", []),
        "angle": ("rad", []),
        "mode": ("", ["idle", "run", "stop"]),
    }


def test_values_as_a_recording_has_them() -> None:
    series = declared()
    series.take(7.0, {"mode": "stop", "status": {"ready": True, "mode": "run", "current": 0.3}})
    series.take(6.5, {"angle": 0.25})
    series.begin_at_zero()
    assert {path: (one.times_s, one.numbers) for path, one in series.items()} == {
        "status.ready": ([0.5], [1.0]),
        "status.mode": ([0.5], [1.0]),
        "status.current": ([0.5], [0.3]),
        "angle": ([0.0], [0.25]),
        "mode": ([0.5], [2.0]),
    }


def test_a_member_that_nobody_declared_gets_the_next_step() -> None:
    one = Series()
    for time_s, text in enumerate(("run", "idle", "run")):
        one.take(time_s, text)
    assert (one.members, one.numbers) == (["run", "idle"], [0.0, 1.0, 0.0])


def test_only_what_is_wanted_is_kept() -> None:
    series = AllSeries(lambda path: path.startswith("x."))
    series.take(0.0, {"x.position": 1, "y.position": 2})
    assert list(series) == ["x.position"]
