# SPDX-License-Identifier: BSD-3-Clause
"""Files of one package that import each other in a circle cannot be understood one by one. Few do."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePosixPath

import pytest
from unit.house.imports import MODULES, imported

pytestmark = pytest.mark.xdist_group("imports")  # one worker, so that the files are read once
Graph = Mapping[PurePosixPath, set[PurePosixPath]]
# The number of files that stand in circles, with imports for types. Lower it, never raise it.
FILES_MOST = 2


def package_graph() -> Graph:
    """Return, for each file, the files of its own package that it imports.

    A package's __init__.py does not count as one of its files.
    """
    inside = [path for path in MODULES.values() if len(path.parts) > 1 and path.name != "__init__.py"]
    return {
        path: {
            target
            for _, name in imported(path)
            if (target := MODULES.get(name)) in inside and target.parts[0] == path.parts[0]
        }
        for path in inside
    }


def reached(graph: Graph, start: PurePosixPath) -> set[PurePosixPath]:
    """Return the files that a file imports, directly or through others."""
    found: set[PurePosixPath] = set()
    to_see = [start]
    while to_see:
        new = graph.get(to_see.pop(), set()) - found
        found |= new
        to_see += new
    return found


def circles(graph: Graph) -> list[set[PurePosixPath]]:
    """Return the largest sets of files in which each imports every other, directly or through others."""
    reach = {path: reached(graph, path) for path in graph}
    sets: list[set[PurePosixPath]] = []
    for path in graph:
        if path in reach[path] and not any(path in known for known in sets):
            sets.append({other for other in reach[path] if path in reach[other]})
    return sets


def test_few_files_import_each_other_in_a_circle() -> None:
    found = circles(package_graph())
    told = [f"{len(circle)}: {' '.join(sorted(map(str, circle)))}" for circle in found]
    assert sum(map(len, found)) <= FILES_MOST, "break one of these:\n" + "\n".join(told)


def test_a_circle_is_found() -> None:
    a, b, c, d = (PurePosixPath(f"x/{name}.py") for name in "abcd")
    assert circles({a: {b}, b: {c}, c: {b, d}, d: set()}) == [{b, c}]
    assert circles({a: {b, c}, b: {d}, c: {d}, d: set()}) == []
