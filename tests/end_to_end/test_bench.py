# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink bench`: its command line works, and every figure can be measured.

No test looks at the number, because that would be a timed test.
"""

from __future__ import annotations

import json
import subprocess
from collections.abc import Callable
from math import isfinite
from pathlib import Path

import pytest

from unitylink_lab.bench import FIGURES
from unitylink_lab.bench import run as measure

# test_rtl, test_ring, tests/ros
ELSEWHERE = {"rtl", "rtl-ring", *(f"ros1-{way}" for way in ("out", "in", "delay"))}
ELSEWHERE |= {"dds-out", "dds-in", "dds-delay", "ros-joints"}

Run = Callable[..., "subprocess.CompletedProcess[str]"]


def test_the_figures_have_names(run: Run) -> None:
    names = run("bench", "--list").stdout.split()
    assert {"sync-read", "in-flight", "version"} <= set(names)
    done = run("bench", "--only", "sync-raed")
    assert done.returncode == 2
    assert all(name in done.stderr for name in names)


def test_a_figure_as_json(run: Run) -> None:
    done = run("bench", "--quick", "--only", "version", "--json")
    assert done.returncode == 0, done.stderr
    report = json.loads(done.stdout)
    assert [figure["name"] for figure in report["figures"]] == ["version"]
    assert report["figures"][0]["measured"] > 0
    assert report["quick"] is True


# These compile first: a package of ROS, as tests/ros does, and crates of Rust, as tests/conformance does.
LONG = {"roscpp-out", "rust-read"}


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.long if name in LONG else ())
        for name in FIGURES
        if name not in ELSEWHERE
    ],
)
def test_figure_yields_a_number(name: str, program: Callable[[str], Path]) -> None:
    said: list[str] = []
    report = measure(only=[name], quick=True, say=said.append)
    assert not report.failures
    (figure,) = report.figures
    assert figure.name == name
    assert isfinite(figure.measured)
    assert figure.measured > 0 or figure.difference
    assert figure.title in report.text()
    assert any(name in message for message in said)
