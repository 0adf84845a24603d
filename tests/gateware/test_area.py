# SPDX-License-Identifier: BSD-3-Clause
"""The gateware does not grow unnoticed: yosys counts again, and the test compares with the record of
`make synth`.
"""

from __future__ import annotations

import dataclasses
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
    """Import tools/synth/flow.py, which is no package."""
    monkeypatch.syspath_prepend(str(ROOT / "tools" / "synth"))
    return importlib.import_module("flow")


def rows() -> Any:
    return importlib.import_module("table").ROWS


def grown(flow: Any, row: Any, recorded: dict[str, Any]) -> list[str]:
    """Return what yosys counts more of than the record has, for a row whose gateware has changed since."""
    if recorded.get("digest") == flow.digest(row):
        return []
    verilog = flow.verilog_of(row)
    if recorded.get("netlist") == flow.netlist_digest(verilog):
        return []
    chip = row.chips[0]
    mapped = flow.map_cells(verilog, flow.top_of(row), flow.CHIPS[chip])
    counts = {"luts": mapped.luts, "flip_flops": mapped.flip_flops}
    return [
        f"{row.name}: {count} {what} instead of {recorded[chip][what]}"
        for what, count in counts.items()
        if count > recorded[chip][what] * GROWTH_MOST
    ]


@pytest.mark.takes(12)
def test_no_row_has_grown_since_it_was_recorded(flow: Any) -> None:
    found = [text for row in rows() for text in grown(flow, row, RECORD[row.name])]
    assert not found, "if it is meant, `make synth ACCEPT=1`"


def test_pages_have_the_figures_of_the_record() -> None:
    page = " ".join((ROOT / "docs" / "gateware" / "core.md").read_text(encoding="utf-8").split())
    core, without = (RECORD[name]["ice40"] for name in ("core", "no_publishing"))
    assert f"has {core['cells']} logic cells and {core['memories']} block RAMs" in page
    assert f"without publishing {without['cells']} and {without['memories']} " in page
    framed, text = (RECORD[name]["ice40"]["memories"] for name in ("hello_led_framed", "hello_led"))
    design = " ".join((ROOT / "docs" / "generate-vhdl.md").read_text(encoding="utf-8").split())
    assert f"{framed} with frames alone, {text} with text alone" in design
    low, high = core["mhz_range"]
    assert f"Its clock is {core['mhz']} MHz (57), the median of three placements ({low} to {high})" in page


def test_a_row_that_has_grown_is_told(flow: Any) -> None:
    row = next(row for row in rows() if row.name == "uart")
    smaller = {"ice40": {"luts": RECORD["uart"]["ice40"]["luts"] // 2, "flip_flops": 1000}}
    assert [text.partition(":")[0] for text in grown(flow, row, smaller)] == ["uart"]


def test_the_digest_is_of_the_gateware_and_of_the_generics(
    flow: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    row = next(row for row in rows() if row.name == "smallest")
    before = flow.digest(row)
    assert flow.digest(dataclasses.replace(row, settings={})) != before
    design = next(row for row in rows() if row.name == "hello_led")
    assert flow.digest(dataclasses.replace(design, protocol="framed")) != flow.digest(design)
    read = flow.plain_text
    monkeypatch.setattr(flow, "plain_text", lambda path: read(path) + " x" * (path.name == "receiver.vhd"))
    assert flow.digest(row) != before


def test_the_record_keeps_the_limits(flow: Any) -> None:
    limited = [row for row in importlib.import_module("table").ROWS if row.cells_most is not None]
    assert limited
    for row in limited:
        assert RECORD[row.name]["ice40"]["cells"] <= row.cells_most
        if row.memories_most is not None:
            assert RECORD[row.name]["ice40"]["memories"] <= row.memories_most


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
        if row.ecp5_mhz_least is not None:
            assert RECORD[row.name]["ecp5"]["mhz"] >= row.ecp5_mhz_least
