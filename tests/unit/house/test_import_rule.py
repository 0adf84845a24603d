# SPDX-License-Identifier: BSD-3-Clause
"""Imports go down the layers only. The only table of allowed imports is in docs/architecture.md.

The last column of a row names what its files import, in backticks: `errors`, `spec/text`. Other words in it
are for people. "anything" means that there is no rule. A name stands for its row and everything below. But in
the row of a part of `spec`, the name `spec` stands for its own row only. Names are paths below src/unitylink
or native/src.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from pathlib import PurePosixPath

import pytest
from unit.house.imports import MODULES, PACKAGE, ROOT, imported

pytestmark = pytest.mark.xdist_group("imports")  # one worker, so that the files are read once
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
NATIVE = PurePosixPath("native/src")


@dataclass(frozen=True)
class Row:
    """A row of the table. Its files and folders are one unit, named after the first of them.

    `allowed` are the units that it may import. None: anything.
    """

    places: tuple[str, ...]
    allowed: frozenset[str] | None


def rows(base: PurePosixPath) -> dict[str, Row]:
    """Return the rows of the table whose paths are below `base`, by unit."""
    table = PAGE.partition("\n## Folders\n")[2].partition("\n## ")[0]
    found: dict[str, Row] = {}
    for row in re.findall(r"^\| (`.*) \|$", table, re.M):
        places, _, targets = (cell.strip() for cell in re.split(r"(?<!\\)\|", row))
        first, *more = (PurePosixPath(name) for name in re.findall(r"`([^`]+)`", places))
        if first.is_relative_to(base):  # `types.py` after `src/unitylink/spec/model.py` is in the same folder
            paths = [str(path.relative_to(base)) for path in (first, *(first.parent / name for name in more))]
            units = tuple(path.removesuffix(".py").removesuffix(".pyi") for path in paths)
            allowed = None if targets.startswith("anything") else frozenset(re.findall(r"`([^`]+)`", targets))
            assert units[0] not in found, f"{units[0]} has two rows"
            found[units[0]] = Row(units, allowed)
    return found


def unit_of(file: PurePosixPath, known: dict[str, Row]) -> str | None:
    """Return the unit of a file, which is the one with the longest path above it."""
    for path in (file.with_suffix(""), *file.parents):
        for unit, row in known.items():
            if str(path) in row.places:
                return unit
    return None


def may(importer: str, target: str, row: Row) -> str | None:
    """Return the word of the row that allows the import. The result is None if no word does."""
    if row.allowed is None or importer == target:
        return target
    for path in (PurePosixPath(target), *PurePosixPath(target).parents):
        inside = path != PurePosixPath(target) and PurePosixPath(importer).is_relative_to(path)
        if str(path) in row.allowed and not inside:
            return str(path)
    return None


ROWS = rows(PACKAGE)


@cache
def edges() -> list[tuple[str, str, str]]:
    """Return (place, unit, unit) for every import between units."""
    found = []
    for path in sorted(MODULES.values()):
        importer = unit_of(path, ROWS)
        for line, name in imported(path):
            if name in MODULES and name != "unitylink":
                target = unit_of(MODULES[name], ROWS)
                if importer is not None and target is not None and importer != target:
                    found.append((f"{PACKAGE / path}:{line}", importer, target))
    return found


def test_every_file_has_a_row() -> None:
    without = [str(path) for path in MODULES.values() if unit_of(path, ROWS) is None]
    assert without == [], "add a row for the new unit to the table of docs/architecture.md"


def test_every_row_is_of_a_folder_or_file() -> None:
    for base in (PACKAGE, NATIVE):
        known = rows(base)
        for unit, row in known.items():
            for place in row.places:
                path = ROOT / base / place
                assert path.is_dir() or any(path.with_suffix(end).is_file() for end in (".py", ".pyi")), place
            assert (row.allowed or frozenset()) <= known.keys(), f"{unit}: a name without a row of its own"


def test_imports_go_down() -> None:
    wrong = [
        f"{place}: {unit} -> {target}"
        for place, unit, target in edges()
        if may(unit, target, ROWS[unit]) is None
    ]
    assert not wrong, "these imports are not in the table of docs/architecture.md:\n" + "\n".join(wrong)


def test_the_table_allows_no_import_that_nobody_makes() -> None:
    made = {(unit, may(unit, target, ROWS[unit])) for _, unit, target in edges()}
    allowed = {(unit, target) for unit, row in ROWS.items() for target in row.allowed or ()}
    assert allowed - made == set(), "take it out of the table of docs/architecture.md"


def test_units_import_each_other_in_no_circle() -> None:
    """A row with "anything" is at the top, so nothing below may import it."""
    below = {unit: {target for _, importer, target in edges() if importer == unit} for unit in ROWS}
    ranked: set[str] = set()
    while free := [unit for unit in below if unit not in ranked and below[unit] <= ranked]:
        ranked.update(free)
    left = {unit: sorted(below[unit] - ranked) for unit in below if unit not in ranked}
    assert left == {}


def test_the_library_imports_the_laboratory_on_demand_only() -> None:
    allowed = {"commands/faults.py"}  # --beside
    made = {str(path) for path in MODULES.values() for _, name in imported(path) if "unitylink_lab" in name}
    assert made <= allowed


def test_native_includes_go_down() -> None:
    known = rows(NATIVE)
    wrong, made = [], set()
    source = ROOT / NATIVE
    for path in sorted([*source.rglob("*.hpp"), *source.rglob("*.cpp")]):
        unit = path.relative_to(source).parts[0]
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
            if line.startswith('#include "') and (target := line.split('"')[1].split("/")[0]) in known:
                made.add((unit, target))
                if may(unit, target, known[unit]) is None:
                    wrong.append(f"{path.relative_to(ROOT)}:{number}: {unit} -> {target}")
    assert not wrong, "these includes are not in the table of docs/architecture.md:\n" + "\n".join(wrong)
    unused = {(unit, target) for unit, row in known.items() for target in row.allowed or ()} - made
    assert unused == set(), "take it out of the table of docs/architecture.md"
