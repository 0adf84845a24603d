# SPDX-License-Identifier: BSD-3-Clause
"""Components drawn at random, on one bus, do the same on `sim:` and on `rtl:`."""

from __future__ import annotations

import random
from dataclasses import replace
from pathlib import Path

import pytest
from gateware.random_robots import differences, play, robot_text


@pytest.mark.long
@pytest.mark.parametrize("seed", [11, 12, 13, 14])
def test_both_boards_do_the_same(seed: int, tmp_path: Path) -> None:
    file = tmp_path / "robot.ul"
    file.write_text(robot_text(random.Random(seed)), "utf-8")
    done, board = play(file, seed)
    assert differences(file, done, board) == []
    wrong = next(at for at in reversed(range(len(done))) if isinstance(done[at].outcome, int))
    outcome = done[wrong].outcome
    assert isinstance(outcome, int)
    done[wrong] = replace(done[wrong], outcome=outcome ^ 1 << 30)
    (told,) = differences(file, done, board)
    assert f"{outcome ^ 1 << 30} on rtl:" in told
