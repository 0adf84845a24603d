# SPDX-License-Identifier: BSD-3-Clause
"""`unitylink new NAME --full` makes a repository whose first CI run passes, and which notices a fault."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from unitylink import connect

from .conftest import Run

pytestmark = pytest.mark.xdist_group("rtl")


def ci_run(folder: Path) -> subprocess.CompletedProcess[str]:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    return subprocess.run(
        [folder / ".ci" / "run"],
        env={**os.environ, "PATH": path, "PYTEST_ADDOPTS": ""},
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )


def test_its_first_ci_run_passes_and_a_fault_of_the_vhdl_fails(run: Run, tmp_path: Path) -> None:
    made = run("new", "rover", "--full")
    assert made.returncode == 0, made.stderr
    folder = tmp_path / "rover"
    done = ci_run(folder)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "stepper_tb: passed" in done.stdout and "5 passed, 1 skipped" in done.stdout

    # without the plant that plays the steppers, `sim:` has their VHDL, as `rtl:` had in that run
    with connect(f"sim:{folder / 'rover.ul'}") as link:
        assert link.board.components["x"].rises("step") == 0

    vhdl = folder / "stepper" / "stepper.vhd"
    vhdl.write_text(vhdl.read_text("utf-8").replace("position - 1", "position - 2"), encoding="utf-8")
    failed = ci_run(folder)
    assert failed.returncode != 0 and "expected" in failed.stdout + failed.stderr


def test_its_program_runs_on_the_twin_whatever_its_folder_is_called(run: Run, tmp_path: Path) -> None:
    folder = tmp_path / "R&D, 100%20"
    made = run("new", "rover", "--full", "--dir", str(folder))
    assert made.returncode == 0, made.stderr
    done = subprocess.run(
        [sys.executable, folder / "run.py"], capture_output=True, text=True, timeout=60, check=False
    )
    assert done.stdout.splitlines()[-1:] == ["x is at 90 deg"], done.stderr
