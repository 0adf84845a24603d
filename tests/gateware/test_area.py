# SPDX-License-Identifier: BSD-3-Clause
"""The gateware does not grow unnoticed: yosys counts again and compares with the record of `make synth`."""

from __future__ import annotations

import importlib
import json
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[2]
GROWTH_MOST = 1.02
WHOLE_RECORD = json.loads((ROOT / "gateware" / "area.json").read_text(encoding="utf-8"))
RECORD = WHOLE_RECORD["rows"]
PAGE = ROOT / "docs" / "gateware" / "area.md"


@pytest.fixture
def flow(monkeypatch: pytest.MonkeyPatch) -> Any:
    """tools/synth/flow.py, which is no package."""
    monkeypatch.syspath_prepend(str(ROOT / "tools" / "synth"))
    return importlib.import_module("flow")


@pytest.mark.parametrize("name", ["core", "no_publishing", "framed_minimal"])
def test_cells_are_those_of_the_record(flow: Any, name: str) -> None:
    row = next(row for row in importlib.import_module("table").ROWS if row.name == name)
    mapped = flow.map_cells(flow.verilog_of(row), row.top, flow.ICE40)
    recorded = RECORD[name]["ice40"]
    assert mapped.luts <= recorded["luts"] * GROWTH_MOST, "grew: if it is meant, `make synth ACCEPT=1`"
    assert mapped.flip_flops <= recorded["flip_flops"] * GROWTH_MOST


def test_the_record_keeps_the_limits(flow: Any) -> None:
    limited = [row for row in importlib.import_module("table").ROWS if row.cells_most is not None]
    assert limited
    for row in limited:
        assert RECORD[row.name]["ice40"]["cells"] <= row.cells_most


def test_every_row_is_recorded_and_the_page_is_the_record(flow: Any) -> None:
    rows = importlib.import_module("table").ROWS
    assert list(RECORD) == [row.name for row in rows], "`make synth` measures what is new"
    assert PAGE.read_text(encoding="utf-8") == importlib.import_module("run").page(
        RECORD, WHOLE_RECORD["tools"]
    )


def test_the_record_keeps_the_clock(flow: Any) -> None:
    limited = [row for row in importlib.import_module("table").ROWS if row.mhz_least is not None]
    assert limited
    for row in limited:
        assert RECORD[row.name]["ice40"]["mhz"] >= row.mhz_least
