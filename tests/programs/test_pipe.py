# SPDX-License-Identifier: BSD-3-Clause
"""A program whose reader goes away ends as others do."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"


@pytest.mark.parametrize("options", [[], ["-u"]])  # without -u, the pipe is written to only at the end
def test_a_reader_that_goes_away_is_no_error(options: list[str]) -> None:
    command = [sys.executable, *options, EXAMPLES / "servo" / "run.py"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None and process.stderr is not None
        process.stdout.close()
        assert process.stderr.read() == ""
    assert process.returncode == 141
