# SPDX-License-Identifier: BSD-3-Clause
"""The VHDL files of a design unit, and their text without comments, for digests of results."""

from __future__ import annotations

import re
from collections.abc import Iterable
from functools import cache
from graphlib import TopologicalSorter
from pathlib import Path

_COMMENT = re.compile(r'("[^"\n]*")|--[^\n]*')
_ENTITY = re.compile(r"\bentity\s+(\w+)\s+is\b")
_UNIT = re.compile(r"\b(?:entity|package)\s+(\w+)\s+is\b")


def needed_sources(top: str, sources: Iterable[Path]) -> list[Path]:
    """Return the files of `sources` whose units `top` needs, with the file of `top`, in order of their names.

    >>> from unitylink.gateware import gateware_sources
    >>> [path.name for path in needed_sources("fifo", gateware_sources())]
    ['fifo.vhd', 'width_pkg.vhd']
    """
    units = units_of(sources)
    wanted, found = [top], set()
    while wanted:
        path = units.get(wanted.pop())
        if path is not None and path not in found:
            found.add(path)
            wanted += _names_in(path)
    return sorted(found, key=lambda path: path.name)


def in_order(sources: Iterable[Path]) -> list[Path]:
    """Return `sources` so that each file stands behind those whose units it needs.

    >>> from unitylink.gateware import gateware_sources
    >>> names = [path.name for path in in_order(gateware_sources())]
    >>> names.index("width_pkg.vhd") < names.index("fifo.vhd")
    True
    """
    units = units_of(paths := list(sources))
    needs = {path: {units[name] for name in _names_in(path) if name in units} - {path} for path in paths}
    return list(TopologicalSorter(needs).static_order())


def units_of(sources: Iterable[Path]) -> dict[str, Path]:
    """Return the entities and packages of `sources`, each with its file."""
    return {name: path for path in sources for name in _UNIT.findall(plain_text(path))}


def entities_of(sources: Iterable[Path]) -> set[str]:
    """Return the names of the entities of `sources`."""
    return {name for path in sources for name in _ENTITY.findall(plain_text(path))}


def _names_in(path: Path) -> list[str]:
    """Return the names of the units of its own library that a file uses."""
    return re.findall(r"\bwork\.(\w+)", plain_text(path))


@cache
def plain_text(path: Path) -> str:
    """Return a VHDL file without comments. A blank stands for each separator."""
    text = _COMMENT.sub(lambda found: found.group(1) or "", path.read_text(encoding="utf-8"))
    return " ".join(text.split())
