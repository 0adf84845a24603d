# SPDX-License-Identifier: BSD-3-Clause
"""Each mistake of native/mutants.toml changes the source as it says, and names a test that exists.

`make mutants` compiles and runs them, which takes minutes. Without this test, only that run would notice a
mistake whose text has gone from the source.
"""

from __future__ import annotations

import re
from pathlib import Path
from types import ModuleType
from typing import Any

import pytest
from unit.modules import module_of

from unitylink._native import fault_profiles

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def tool() -> ModuleType:
    return module_of(ROOT / "tools" / "mutants.py")


@pytest.fixture(scope="module")
def mutants(tool: ModuleType) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = tool.read_mutants()
    return found


def test_every_text_to_find_stands_once_in_its_file(tool: ModuleType, mutants: list[dict[str, Any]]) -> None:
    for mutant in mutants:
        for name, text in tool.edited(mutant).items():
            assert text != (tool.SOURCES / name).read_text("utf-8"), mutant["name"]


def test_a_text_that_has_gone_is_named(tool: ModuleType, mutants: list[dict[str, Any]]) -> None:
    gone = {**mutants[0], "find": "no file has this"}
    with pytest.raises(
        SystemExit, match=re.escape(f"{gone['name']}: {gone['file']} has this 0 times instead of once")
    ):
        tool.edited(gone)


def test_every_mutant_is_compiled_and_has_a_test(tool: ModuleType, mutants: list[dict[str, Any]]) -> None:
    profiles = {name for name, *_ in fault_profiles()}
    histories = (ROOT / "tests" / "apart" / "histories.py").read_text("utf-8")
    names = [mutant["name"] for mutant in mutants]
    assert len(names) == len(set(names)) > 30
    for mutant in mutants:
        assert tool.units_of(mutant), f"{mutant['name']}: nothing is compiled: give it `units`"
        for pattern in mutant.get("units", []):
            assert list(tool.SOURCES.glob(pattern)), f"{mutant['name']}: no file is {pattern}"
        (judge,) = mutant.keys() & {"profile", "test", "apart"}
        named = mutant[judge]
        known = {
            "profile": named in profiles,
            "test": (tool.TESTS / str(named)).is_file(),
            "apart": f'"{named}": Profile(' in histories,
        }
        assert known[judge], f"{mutant['name']}: there is no {judge} {named!r}"
