# SPDX-License-Identifier: BSD-3-Clause
"""The pictures of the robots are drawn from their recorded runs."""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).resolve().parents[3]
TOOLS = ROOT / "tools" / "docs"


@pytest.fixture
def robots(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    monkeypatch.syspath_prepend(str(TOOLS))
    found = importlib.util.spec_from_file_location("tool_robots", TOOLS / "robots.py")
    assert found is not None and found.loader is not None
    tool = importlib.util.module_from_spec(found)
    monkeypatch.setitem(sys.modules, found.name, tool)
    found.loader.exec_module(tool)
    yield tool


def test_the_pictures_are_those_of_the_runs(robots: Any) -> None:
    pages = "".join((ROOT / "docs" / page).read_text("utf-8") for page in ("robots.md", "plants.md"))
    for name in robots.PICTURES:
        drawn = (robots.IMAGES / f"{name}.svg").read_text("utf-8")
        assert drawn == robots.draw(name), "`python tools/docs/robots.py` draws them"
        assert f"images/{name}.svg" in pages


@pytest.mark.parametrize(("low", "high"), [(0.0, 4.2), (-0.02, 0.42), (57.0, 123.0), (-260.0, 260.0)])
def test_ticks_are_some_round_numbers(robots: Any, low: float, high: float) -> None:
    ticks = robots.ticks(low, high)
    assert 3 <= len(ticks) <= 12 and low <= ticks[0] and ticks[-1] <= high
    assert len({round(b - a, 9) for a, b in pairwise(ticks)}) == 1
