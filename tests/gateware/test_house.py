# SPDX-License-Identifier: BSD-3-Clause
"""Every entity has a bench and a page, and its page describes its generics."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FILES = [
    file for file in sorted((ROOT / "gateware").rglob("*.vhd")) if file.parent.name not in ("test", "formal")
]
ENTITIES = {
    match.group(1): file
    for file in FILES
    for match in re.finditer(r"^entity (\w+) is", file.read_text(encoding="utf-8"), re.MULTILINE)
}
BENCHES = "\n".join(
    file.read_text(encoding="utf-8") for file in (ROOT / "gateware" / "test").glob("*_tb.vhd")
)
ENDS_BY_ITSELF = {
    "fifo_publish_tb": "at its last clock",
    "lockstep_tb": "at the end of its file",
    "rate_pkg_tb": "it has no clock",
    "replay_tb": "at the end of its file, and each step has its own limit",
}
PAGES = {file.stem for file in (ROOT / "docs" / "gateware").glob("*.md")}


@pytest.mark.parametrize("entity", ENTITIES)
def test_entity_has_a_bench_and_a_page(entity: str) -> None:
    assert f"entity work.{entity}\n" in BENCHES, f"no bench in gateware/test instantiates {entity}"
    assert entity in PAGES, f"docs/gateware/{entity}.md is missing"


@pytest.mark.parametrize("page", sorted(set(ENTITIES) & PAGES))
def test_page_names_every_generic(page: str) -> None:
    text = (ROOT / "docs" / "gateware" / f"{page}.md").read_text(encoding="utf-8")
    source = ENTITIES[page].read_text(encoding="utf-8")
    block = re.search(rf"entity {page} is\s+generic \((.*?)\n  \);", source, re.DOTALL)
    names = re.findall(r"^    (\w+)\s*:", block.group(1), re.MULTILINE) if block else []
    missing = [name for name in names if not re.search(rf"\b{name}\b", text)]
    assert not missing, f"docs/gateware/{page}.md does not name the generics {missing}"


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_files_are_short_and_licensed(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert text.startswith("-- SPDX-License-Identifier: BSD-3-Clause")
    assert len(text.splitlines()) <= 450
    assert all(len(line) <= 130 for line in text.splitlines())


@pytest.mark.parametrize(
    "bench", sorted((ROOT / "gateware" / "test").glob("*_tb.vhd")), ids=lambda file: file.stem
)
def test_bench_has_a_watchdog_that_names_it(bench: Path) -> None:
    named = re.findall(r'^  watchdog\(\w+, .+, "(\w+)"\);$', bench.read_text(encoding="utf-8"), re.MULTILINE)
    assert named == ([] if bench.stem in ENDS_BY_ITSELF else [bench.stem])
