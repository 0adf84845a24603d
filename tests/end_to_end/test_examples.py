# SPDX-License-Identifier: BSD-3-Clause
"""The examples run, each in a process of its own."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


def run(example: str, *arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-W", "error", str(EXAMPLES / example / "run.py"), *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)


@pytest.mark.parametrize(
    ("example", "arguments", "said"),
    [
        ("hello_led", [], "LEDs 0100"),
        ("walker18", ["--cycles", "1"], "The walker is there."),
        ("walker18", ["--cycles", "1", "--spec", "walker18_si.ul"], "The walker is there."),
        ("pa10", ["--pace", "2"], "Both arms are home again."),
        ("pa10", ["--pace", "2", "--spec", "pa10.ul"], "Both arms are home again."),
        ("dashboard", ["--seconds", "2"], "j1.cpos and 7 more: "),
        ("servo", [], "the limit switch has closed, 1 in all"),
        ("belt_axis", [], "the carriage goes at 0.4"),
        ("belt_axis", ["--rtl"], "the carriage goes at 0.4"),
        ("diff_drive", [], "back, "),
        ("foc_joint", [], "all angles are reached, and the bridge is off"),
        ("scara_stepper", [], "the arm is home again"),
        ("bus_arm", [], "the arm is home, and holds"),
        ("xyz_stage", [], "corner 60, 60: the counters are at 60.0000, 60.0000 mm"),
        ("position_loop", [], "the loop is off: duty 0.0"),
        ("position_loop", ["--rtl"], "the loop is off: duty 0.0"),
        ("profile", [], "a step: 32 points in one commit, 32 samples"),
    ],
)
def test_example_runs(example: str, arguments: list[str], said: str) -> None:
    done = run(example, *arguments)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout
    assert said in done.stdout


_LINKED = [
    "dashboard",
    "diff_drive",
    "foc_joint",
    "hello_led",
    "profile",
    "scara",
    "servo",
    "walker18",
    "xyz_stage",
]


@pytest.mark.parametrize("example", _LINKED)
def test_example_says_what_is_wrong_with_a_link(example: str) -> None:
    done = run(example, "--link", "tcp://127.0.0.1:1")
    assert done.returncode == 1
    assert done.stderr.startswith(f"{example}: ") and "Traceback" not in done.stderr
