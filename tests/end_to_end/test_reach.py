# SPDX-License-Identifier: BSD-3-Clause
"""`make demo-learn` in short: a little training with a seed, and a drive past a cut line on the twin."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

from .conftest import MUJOCO

pytestmark = MUJOCO

EXAMPLE = Path(__file__).parents[2] / "examples" / "reach"

LITTLE = """
from train import Effort, train
effort = Effort(generations=3, policies=10, best=3, targets=1, boards=5, seed=3)
first, second = (train(effort, processes=1, say=lambda line: None) for _ in range(2))
assert first.steps == 3 * 10 * 40
assert first.curve[-1, 2] > first.curve[0, 2] + 0.02, first.curve
assert first.numbers.tolist() == second.numbers.tolist()
assert first.curve.tolist() == second.curve.tolist()
"""


def run(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *arguments], cwd=EXAMPLE, capture_output=True, text=True, check=False
    )


def test_a_little_training_is_better_than_none_and_the_same_each_time() -> None:
    done = run("-c", LITTLE)
    assert done.returncode == 0, done.stderr


def test_the_policy_drives_on_behind_a_cut_line(tmp_path: Path) -> None:
    picture = tmp_path / "reach.svg"
    done = run("run.py", "--policy", "policy.txt", "--picture", picture)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "no jump" in done.stdout
    assert "safe until the line was back, 500 ms: True" in done.stdout
    assert picture.stat().st_size > 10_000


def test_a_policy_that_has_learned_nothing_is_told(tmp_path: Path) -> None:
    nothing = tmp_path / "nothing.txt"
    nothing.write_text("0\n" * 12)
    done = run("run.py", "--policy", nothing)
    assert done.returncode == 1, done.stderr
    assert "mm" in done.stdout
    missing = run("run.py", "--policy", tmp_path / "absent.txt")
    assert missing.returncode == 1
    assert "absent.txt" in missing.stderr
    assert "Traceback" not in missing.stderr
