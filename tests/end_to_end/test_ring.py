# SPDX-License-Identifier: BSD-3-Clause
"""The robot that is a ring of five nodes, as `make demo-tosnet` runs it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from unitylink_lab.bench import run as bench

ROOT = Path(__file__).resolve().parents[2]

pytestmark = pytest.mark.xdist_group("ring")  # one build of its designs


@pytest.mark.parametrize("options", [["--twin"], []], ids=["twins", "designs"])
def test_the_ring_loses_a_fibre_and_goes_on(options: list[str], tmp_path: Path) -> None:
    picture = tmp_path / "ring.svg"
    command = [sys.executable, str(ROOT / "examples/scara_ring/run.py"), *options, "--picture", str(picture)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "a write says: targets: the TosNet network is offline" in done.stdout
    safe = re.search(r"all gates are off ([\d.]+) ms after the cut, and it may take ([\d.]+) ms", done.stdout)
    assert safe and float(safe[1]) <= float(safe[2])
    assert "mended: all joints are at their second target" in done.stdout
    assert "a fibre is cut" in picture.read_text(encoding="utf-8")


def test_its_speed_is_measured() -> None:
    """Here, because the five designs are compiled for the test above."""
    report = bench(only=["rtl-ring"], quick=True, say=lambda message: None)
    assert report.figures[0].measured > 0 and not report.figures[0].complaint
