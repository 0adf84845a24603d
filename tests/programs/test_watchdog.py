# SPDX-License-Identifier: BSD-3-Clause
"""A test that hangs ends the run, and says where all threads are."""

from __future__ import annotations

import faulthandler
import os
import subprocess
import sys
from pathlib import Path

import pytest
from watchdog import HANG_S, MORE, Watchdog

TESTS = Path(__file__).resolve().parents[1]
HANGS = """
import time
import pytest

def test_that_fails():
    assert False

@pytest.mark.patience(0.5)
def test_that_hangs():
    time.sleep(60)
"""


def test_a_test_that_hangs_ends_the_run_with_its_stack(tmp_path: Path) -> None:
    (tmp_path / "test_it.py").write_text(HANGS, encoding="utf-8")
    configuration = ["-c", TESTS.parent / "pyproject.toml", "--rootdir", tmp_path, "-p", "conftest"]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *configuration, "-q", tmp_path / "test_it.py"],
        env={**os.environ, "PYTHONPATH": str(TESTS)},
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 1
    assert done.stderr.startswith("Timeout") and "in test_that_hangs" in done.stderr


def test_one_watch_is_for_many_tests(monkeypatch: pytest.MonkeyPatch) -> None:
    armed_s: list[float] = []
    monkeypatch.setattr(faulthandler, "dump_traceback_later", lambda most_s, **_: armed_s.append(most_s))
    now_s = [1000.0]
    monkeypatch.setattr("time.monotonic", lambda: now_s[0])
    watchdog = Watchdog(2)
    usual_s, long_s = HANG_S * (1 + MORE), 3600 * (1 + MORE)
    for later_s, hang_s, expected in (
        (0, HANG_S, [usual_s]),
        (HANG_S * MORE - 1, HANG_S, [usual_s]),
        (2, HANG_S, [usual_s] * 2),  # too little time is left
        (0, 3600, [usual_s, usual_s, long_s]),
        (0, HANG_S, [usual_s, usual_s, long_s, usual_s]),  # a usual test would get too much
    ):
        now_s[0] += later_s
        watchdog.watch(hang_s)
        assert armed_s == expected
    watchdog.disarmed()
    watchdog.watch()
    assert len(armed_s) == 5
