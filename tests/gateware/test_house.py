# SPDX-License-Identifier: BSD-3-Clause
"""Every entity has a bench and a page, and its page describes its generics."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from gateware.simulators import STRICT, called, executable

from unitylink.gateware import bench_sources, every_source, gateware_sources, simulation_sources
from unitylink.gateware.dependencies import in_order

ROOT = Path(__file__).resolve().parents[2]
FILES = [*gateware_sources(), *simulation_sources()]
BENCHES = [file for file in bench_sources() if file.stem.endswith("_tb")]
ENTITIES = {
    match.group(1): file
    for file in FILES
    for match in re.finditer(r"^entity (\w+) is", file.read_text(encoding="utf-8"), re.MULTILINE)
}
ALL_BENCHES = "\n".join(file.read_text(encoding="utf-8") for file in BENCHES)
ENDS_BY_ITSELF = {
    "fifo_publish_tb": "at its last clock",
    "frame_timing_tb": "it has no clock",
    "lockstep_tb": "at the end of its file",
    "program_sharing_tb": "it has no clock",
    "rate_pkg_tb": "it has no clock",
    "replay_tb": "at the end of its file, and each step has its own limit",
}
PAGES = {file.stem: file for file in (ROOT / "docs" / "gateware").glob("*.md")}
PAGES |= {file.parent.name: file for file in (ROOT / "components").glob("*/README.md")}
# A part of a component is in its folder, begins with its name, and is tested through it.
PARTS = {
    name: file.parent.name
    for name, file in ENTITIES.items()
    if file.parent.parent.name == "components" and name.startswith(f"{file.parent.name}_")
}


def test_ghdl_warns_of_nothing(tmp_path: Path) -> None:
    called(
        [executable("ghdl", "ghdl-mcode"), "-a", "--std=08", *STRICT, *map(str, in_order(every_source()))],
        tmp_path,
    )


@pytest.mark.parametrize("entity", ENTITIES)
def test_entity_has_a_bench_and_a_page(entity: str) -> None:
    whole = PARTS.get(entity, entity)
    assert f"entity work.{whole}\n" in ALL_BENCHES, f"no bench instantiates {whole}"
    assert whole in PAGES, f"docs/gateware/{entity}.md or components/{entity}/README.md is missing"


@pytest.mark.parametrize("page", sorted(set(ENTITIES) & set(PAGES)))
def test_page_names_every_generic(page: str) -> None:
    text = PAGES[page].read_text(encoding="utf-8")
    source = ENTITIES[page].read_text(encoding="utf-8")
    block = re.search(rf"entity {page} is\s+generic \((.*?)\n  \);", source, re.DOTALL)
    names = re.findall(r"^    (\w+)\s*:", block.group(1), re.MULTILINE) if block else []
    missing = [name for name in names if not re.search(rf"\b{name}\b", text)]
    assert not missing, f"{PAGES[page]} does not name the generics {missing}"


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_files_are_short_and_licensed(file: Path) -> None:
    text = file.read_text(encoding="utf-8")
    assert text.startswith("-- SPDX-License-Identifier: BSD-3-Clause")
    assert len(text.splitlines()) <= 450
    assert all(len(line) <= 130 for line in text.splitlines())


@pytest.mark.parametrize("bench", BENCHES, ids=lambda file: file.stem)
def test_bench_has_a_watchdog_that_names_it(bench: Path) -> None:
    named = re.findall(r'^  watchdog\(\w+, .+, "(\w+)"\);$', bench.read_text(encoding="utf-8"), re.MULTILINE)
    assert named == ([] if bench.stem in ENDS_BY_ITSELF else [bench.stem])
