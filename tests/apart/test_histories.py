# SPDX-License-Identifier: BSD-3-Clause
"""Exactly-once between programs that are killed. The long form is `tests/apart/histories.py --messages N`."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

HERE = Path(__file__).parent


@pytest.mark.parametrize("profile", ["udp", "pty", "kills", "classic-tcp"])
def test_a_short_history_without_violations(profile: str, journal_board: Path) -> None:
    one = ["--profile", profile, "--messages", "1", "--words", "3000", "--seed", "7"]
    done = subprocess.run(
        [sys.executable, HERE / "histories.py", "--board", journal_board, *one],
        capture_output=True,
        text=True,
        timeout=300,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = re.findall(r"(\d[\d,]*) (\w[\w ]*)", done.stdout)
    counts = {what: int(count.replace(",", "")) for count, what in found}
    assert counts["writes executed"] > 1000
    assert counts["read"] > 1000
    assert counts["faults"] > 0
