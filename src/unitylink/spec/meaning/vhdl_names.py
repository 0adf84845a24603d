# SPDX-License-Identifier: BSD-3-Clause
"""Does the VHDL of a component of one's own have the names that the spec gives to it?

GHDL would find a wrong name too, but in generated text that the user has not written. Here it is told at its
place. The VHDL is not parsed: a name that stands nowhere in the declaration of the entity is no port and no
generic of it. What else may be wrong, the tools tell that elaborate it.
"""

from __future__ import annotations

import re
from functools import lru_cache
from pathlib import Path

from ..report.diagnostics import Reporter
from ..source import MAX_BYTES
from ..text.syntax import AnnotationNode

_NO_NAME = re.compile(r'"[^"\n]*"|--[^\n]*|/\*.*?\*/', re.DOTALL)
_WORD = re.compile(r"\w+", re.ASCII)
_END = re.compile(r"\bend\b", re.IGNORECASE)


def check_names(
    entity: str, sources: list[str], told: list[tuple[AnnotationNode, str]], reporter: Reporter
) -> None:
    """Report the first name that `entity` lacks. `told` has each with the annotation that says it.

    Nothing is reported if no file of `sources` declares the entity: `generate` names the file then.
    """
    words = frozenset[str]().union(*(_head(Path(path), entity) for path in sources))
    wrong = next(((node, name) for node, name in told if name.lower() not in words), None)
    if words and wrong is not None:
        node, name = wrong
        message = f"entity `{entity}` has no port or generic `{name}`"
        hint = f"write it as in {', '.join(Path(path).name for path in sources)}, or add it there"
        reporter.report("UL098", node.name.start, node.name.end, message, hint)


def _head(path: Path, entity: str) -> frozenset[str]:
    try:
        return _words_in(path, path.stat().st_mtime_ns, entity)
    except OSError:  # `find_source` names a file that is not there
        return frozenset()


@lru_cache(maxsize=256)
def _words_in(path: Path, _changed: int, entity: str) -> frozenset[str]:
    """Return the words of an entity's declaration in lower case, or none if it is not there."""
    with path.open("rb") as file:
        text = _NO_NAME.sub(" ", file.read(MAX_BYTES).decode("utf-8", "replace"))
    start = re.search(rf"\bentity\s+{re.escape(entity)}\s+is\b", text, re.IGNORECASE)
    end = _END.search(text, start.end()) if start else None  # without an end it was cut, or is no VHDL
    head = text[start.start() : end.start()] if start and end else ""
    return frozenset(word.lower() for word in _WORD.findall(head))
