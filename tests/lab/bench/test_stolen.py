# SPDX-License-Identifier: BSD-3-Clause
"""The time that the host of a virtual machine took away stands beside every figure."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink_lab.bench.stolen import ProcessorTime


def test_the_share_of_two_readings(tmp_path: Path) -> None:
    stat = tmp_path / "stat"
    stat.write_text("cpu  10 0 10 70 0 0 0 10 9 9\ncpu0 1 2 3\n")
    before = ProcessorTime.read(stat)
    stat.write_text("cpu  60 0 10 90 0 0 0 40 9 9\n")
    after = ProcessorTime.read(stat)
    assert before and after and after.stolen_percent(since=before) == 30


@pytest.mark.parametrize("text", ["", "cpu\n", "cpu 1 2 3\n", "cpu a b c d e f g h\n"])
def test_a_system_without_the_counters(text: str, tmp_path: Path) -> None:
    (tmp_path / "stat").write_text(text)
    assert ProcessorTime.read(tmp_path / "stat") is None
    assert ProcessorTime.read(tmp_path / "none") is None
