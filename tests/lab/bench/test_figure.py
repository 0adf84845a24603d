# SPDX-License-Identifier: BSD-3-Clause
"""A figure is met when it reaches its limit and there is no complaint about the number."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink_lab.bench import Report
from unitylink_lab.bench.figure import Figure
from unitylink_lab.bench.timing import in_turns, times

positive = st.floats(min_value=1e-3, max_value=1e9)


@given(limit=positive, measured=positive)
def test_met_is_on_the_asked_side(limit: float, measured: float) -> None:
    upper = Figure("a", "a", limit, True, measured, "x")
    lower = Figure("a", "a", limit, False, measured, "x")
    assert upper.met == (measured <= limit)
    assert lower.met == (measured >= limit)
    assert not Figure("a", "a", limit, True, measured, "x", complaint="messages were lost").met


@given(
    rounds=st.integers(1, 9),
    count=st.integers(1, 20),
    ours=st.integers(1, 10**9),
    theirs=st.integers(1, 10**9),
)
def test_both_sides_are_measured_equally_often(rounds: int, count: int, ours: int, theirs: int) -> None:
    asked: list[str] = []

    def side(name: str, value: int, n: int) -> list[int]:
        asked.append(name)
        assert n == count
        return [value] * n

    result = in_turns(
        lambda n: side("ours", ours, n), lambda n: side("theirs", theirs, n), rounds=rounds, count=count
    )
    assert asked.count("ours") == asked.count("theirs") == rounds
    assert asked[:3] == ["ours", "theirs", "theirs"][: 2 * rounds][:3]
    assert result.ratio == result.low == result.high == ours / theirs


def test_a_slow_second_does_not_move_the_ratio() -> None:
    speed = iter([1, 1, 1, 1, 50, 50, 1, 1, 1, 1])  # a slow moment hits both sides of one round
    result = in_turns(
        lambda n: [3 * s for s in [next(speed)] * n],
        lambda n: [2 * s for s in [next(speed)] * n],
        rounds=5,
        count=3,
    )
    assert result.ratio == 1.5


def test_times_calls_as_often_as_asked_and_times_each(monkeypatch: pytest.MonkeyPatch) -> None:
    clock_ns = [0]
    monkeypatch.setattr("unitylink_lab.bench.timing.perf_counter_ns", lambda: clock_ns[0])
    calls: list[int] = []

    def call() -> None:
        calls.append(len(calls))
        clock_ns[0] += 10 * len(calls)

    assert list(times(call, 17)) == [10 * (call + 1) for call in range(17)]
    assert len(calls) == 17


def test_report_shows_and_saves_what_was_missed(tmp_path: Path) -> None:
    report = Report(
        (
            Figure("fast", "a fast thing", 10.0, False, 12.5, "x", {"us": 3.0}),
            Figure("slow", "a slow thing", 1.5, True, 1.7, "s"),
            Figure(
                "lossy", "a lossy thing", 10.0, True, 2.0, "%", complaint="3 of 9 messages did not arrive"
            ),
        )
    )
    assert not report.met
    assert [row[-1] for row in report.rows()] == ["yes", "NO", "NO"]
    text = report.text()
    assert "2 of 3 figures missed" in text
    assert "3 of 9 messages did not arrive" in text
    path = tmp_path / "deep" / "bench.json"
    report.write(path)
    saved = json.loads(path.read_text())
    assert [figure["met"] for figure in saved["figures"]] == [True, False, False]
    assert saved["figures"][0]["details"] == {"us": 3.0}
    assert list(path.parent.iterdir()) == [path]
