# SPDX-License-Identifier: BSD-3-Clause
"""Level 1 has the paper's clocks for the 2012 gateware and the page's for ours."""

from __future__ import annotations

from pathlib import Path

import pytest

from unitylink.experiments.gateware import CORE, CORE_CHECKED_PERIOD
from unitylink.experiments.level_one import core, effect_2012_clocks, gateware_2012
from unitylink.experiments.low_level import read, read_many, write

PAGE = Path(__file__).resolve().parents[3] / "docs" / "gateware" / "core.md"


def page_row(start: str) -> int:
    row = next(
        line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith(f"| {start}")
    )
    return int(row.split("|")[2])


def test_the_2012_gateware_is_the_paper_s() -> None:
    reads, writes = gateware_2012(read()), gateware_2012(write())
    assert (reads.latency_clocks, writes.latency_clocks) == (57, 63)
    assert reads.request_hz == pytest.approx(85.7e6, rel=1e-3)
    assert reads.reply_hz == pytest.approx(200e6, rel=1e-3)
    assert writes.request_hz == pytest.approx(151.3e6, rel=1e-3)
    assert writes.reply_hz == pytest.approx(54.1e6, rel=1e-2)
    assert effect_2012_clocks() == 50


@pytest.mark.parametrize("words", [1, 4, 32])
def test_a_read_of_many_words_costs_what_the_simulation_said(words: int) -> None:
    assert gateware_2012(read_many(words)).period_clocks == 14 + 16 * words


def test_our_figures_are_those_the_rtl_is_held_to() -> None:
    assert page_row("read, last byte in to first byte out") == CORE[b"#R"].first_out
    assert page_row("read, last in to last out") == CORE[b"#R"].last_out
    assert page_row("period of pipelined reads") == CORE[b"#R"].period
    assert page_row("period of pipelined writes") == CORE[b"#W"].period
    assert page_row("read through a FIFO each side") == core(read()).latency_clocks
    assert page_row("write through a FIFO each side") == core(write()).latency_clocks
    assert {
        b"$R": page_row("the same with checksum (17 bytes) "),
        b"$W": page_row("the same with checksum (17 bytes in)"),
    } == CORE_CHECKED_PERIOD
