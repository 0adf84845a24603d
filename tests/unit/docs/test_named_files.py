# SPDX-License-Identifier: BSD-3-Clause
"""Every file of this checkout that a page names in code type exists."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
FOLDERS = (
    "bench",
    "boards",
    "cmake",
    "components",
    "docs",
    "editors",
    "examples",
    "gateware",
    "native",
    "protocol",
)
FOLDERS += ("src", "tests", "tools")
PAGES = sorted(page for folder in (".", *FOLDERS) for page in (ROOT / folder).glob("*.md"))
PAGES += sorted([*(ROOT / "docs" / "gateware").glob("*.md"), *(ROOT / "components").glob("*/*.md")])
NAMED = re.compile(rf"`((?:{'|'.join(FOLDERS)})/[\w./*-]+)`")
LATER = {  # files that are not in this checkout: the reader makes them, or they belong to a generated package
    "docs/gateware/testing.md": {"gateware/test/blinker_tb.vhd"},
    "docs/ros.md": {"src/ros2_control.cpp", "src/node.cpp"},
}


def test_named_files_are_there() -> None:
    gone = []
    for page in PAGES:
        name = str(page.relative_to(ROOT))
        named = set(NAMED.findall(page.read_text("utf-8"))) - LATER.get(name, set())
        placeholders = {file for file in named if re.search(r"[A-Z]{4}", file)}  # boards/NAME/board.toml
        gone += [
            f"{name}: {file}" for file in sorted(named - placeholders) if not any(ROOT.glob(file.rstrip("/")))
        ]
    assert not gone, "pages name these files, and they are not there"
