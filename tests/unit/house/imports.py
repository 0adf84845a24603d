# SPDX-License-Identifier: BSD-3-Clause
"""Which module of the package imports which, read from the sources.

Nested imports and imports for types count too.
"""

from __future__ import annotations

import ast
from collections.abc import Iterator
from functools import cache
from pathlib import PurePosixPath

from unit.house.files import ROOT, text

PACKAGE = PurePosixPath("src/unitylink")


def modules() -> dict[str, PurePosixPath]:
    """Return every module of the package with its path below it."""
    found = {}
    for file in (ROOT / PACKAGE).rglob("*.py*"):
        if file.suffix in (".py", ".pyi"):
            path = PurePosixPath(file.relative_to(ROOT / PACKAGE))
            parts = ("unitylink", *path.with_suffix("").parts)
            found[".".join(part for part in parts if part != "__init__")] = path
    return found


MODULES = modules()


def statements(tree: ast.AST) -> Iterator[ast.AST]:
    """Yield each statement, however deeply nested, and none of their expressions."""
    within = [tree]
    while within:
        node = within.pop()
        yield node
        for block in ("body", "handlers", "orelse", "finalbody", "cases"):
            within += getattr(node, block, ())


@cache
def imported(path: PurePosixPath) -> list[tuple[int, str]]:
    """Return (line, module) for every module of ours that a file imports, however deeply nested."""
    found = []
    package = ("unitylink", *path.parent.parts)
    for node in statements(ast.parse(text(PACKAGE / path))):
        if isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            start = package[: len(package) - node.level + 1] if node.level else ()
            module = ".".join((*start, *(node.module.split(".") if node.module else ())))
            names = [m if (m := f"{module}.{alias.name}") in MODULES else module for alias in node.names]
        else:
            continue
        found += [(node.lineno, name) for name in names if name.partition(".")[0].startswith("unitylink")]
    return found
