# SPDX-License-Identifier: BSD-3-Clause
"""Every component has its area measured, and its page says the figures of the record gateware/area.json."""

from __future__ import annotations

import importlib
import json
import re
from typing import Any

import pytest
from unit.house.files import ROOT, files, text

RECORD: dict[str, dict[str, Any]] = json.loads(text("gateware/area.json"))["rows"]
NAMES = sorted(file.parts[1] for file in files() if file.match("components/*/README.md"))
# what a page says of its row -> the figure of the record
CLAIMS = {
    r"(\d+) logic cells": "cells",
    r"(\d+) LUT4 of an iCE40": "luts",
    r"takes (\d+) LUT4": "luts",
    r"Ours has (\d+) and \d+": "luts",
    r"Ours has \d+ and (\d+)": "flip_flops",
    r"logic cells[^.]*? and (\d+|a) (?:block RAM|block memor|memor)": "memories",
    r"can have (\d+) MHz": "mhz",
}


def wrong(name: str, page: str, figures: dict[str, Any]) -> list[str]:
    """Return what a page says that is not in the figures of the component."""
    words = " ".join(page.split())
    return [
        f"components/{name}/README.md: {found[0]!r}, and the record has {figures[key]} {key}"
        for claim, key in CLAIMS.items()
        for found in re.finditer(claim, words)
        if (1 if found[1] == "a" else int(found[1])) != int(figures[key])
    ]


@pytest.fixture
def synth(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Return a function that imports a module of tools/synth, which is no package."""
    monkeypatch.syspath_prepend(str(ROOT / "tools" / "synth"))
    return importlib.import_module


def test_every_component_with_vhdl_has_an_area_row(synth: Any) -> None:
    rows = {row.name: row.top for row in synth("component_rows").COMPONENT_ROWS}
    own = [name for name in NAMES if (ROOT / "components" / name / f"{name}.vhd").exists()]
    assert len(own) >= 29
    assert [name for name in own if name not in rows or name not in RECORD] == []
    assert [name for name in own if rows[name].removeprefix("narrow_") != name] == []


def test_the_pages_say_the_figures_of_the_record() -> None:
    pages = {name: text(f"components/{name}/README.md") for name in NAMES}
    found = [one for name, page in pages.items() for one in wrong(name, page, RECORD[name]["ice40"])]
    assert not found, "write what is recorded:\n" + "\n".join(found)
    claimed = sum(len(re.findall(r"\d+ logic cells", " ".join(page.split()))) for page in pages.values())
    assert claimed >= 20, "the test no longer finds the sentences"


def test_a_wrong_figure_is_found() -> None:
    figures = {"cells": 230, "luts": 165, "flip_flops": 138, "memories": 1, "mhz": 84.9}
    page = "It takes 230\nlogic cells and a block RAM. Ours has 165 and 138. It can have 84 MHz."
    assert wrong("x", page, figures) == []
    for right, false in (("230", "243"), (" a ", " 2 "), ("165", "166"), ("138", "83"), ("84", "85")):
        assert len(wrong("x", page.replace(right, false), figures)) == 1, false


def test_the_pages_and_the_table_agree_about_other_libraries(synth: Any) -> None:
    peers = synth("peers").COMPONENT_PEERS
    known = {(one.row, one.library): (one.luts, one.flip_flops) for one in peers}
    told = {
        (name, library): (int(luts), int(flip_flops))
        for name in NAMES
        for library, luts, flip_flops in re.findall(
            r"(riocore|hostmot2)'s has (\d+) look-up tables and (\d+) flip-flops",
            " ".join(text(f"components/{name}/README.md").split()),
        )
    }
    assert len(told) >= 3
    assert told == {key: known.get(key) for key in told}
    page = text("docs/gateware/area.md")
    assert "\n".join(synth("peers").peers_table(RECORD)) in page, "`make synth ACCEPT=1` writes the page"
