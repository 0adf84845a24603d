# SPDX-License-Identifier: BSD-3-Clause
"""Answers that change a text: rename, formatting, fixes. None of them makes a valid spec wrong."""

from __future__ import annotations

import re

from lsprotocol import types

from unitylink.errors import SpecError
from unitylink.spec import Diagnostic, compile_text, format_text
from unitylink.spec.fix import edited
from unitylink.spec.report.diagnostics import Edit
from unitylink.spec.text.lexer import KEYWORDS, MAX_NAME

from .document import Document
from .project import Project, place_of

_NAME = re.compile(rf"[A-Za-z_][A-Za-z_0-9]{{0,{MAX_NAME - 1}}}")


class RenameRefused(Exception):
    """A name cannot be changed to another. The message says why."""


def rename(document: Document, offset: int, new_name: str, project: Project) -> dict[str, list[Edit]]:
    """Return the edits, by real path of the file, that rename the symbol at `offset` everywhere.

    Everywhere means all specs of the project that import the file with the declaration, and that file itself.
    If one of them would have more errors than before, nothing is changed.
    """
    found = document.symbols.at(offset)
    if found is None:
        raise RenameRefused("there is no name here")
    symbol, _ = found
    definition = symbol.defined or symbol.declared or symbol.places[0]
    if document.symbols.sources.in_library(definition.start):
        raise RenameRefused(f"`{symbol.name}` belongs to the component library")
    new_name = new_name.removeprefix("^")
    if not _NAME.fullmatch(new_name):
        raise RenameRefused(f"`{new_name}` is not a name: names are made of A-Z a-z 0-9 _")
    word = f"^{new_name}" if new_name in KEYWORDS else new_name
    places = project.places(symbol.name, place_of(document.symbols, definition))
    edits: dict[str, list[Edit]] = {}
    for file, start, end in sorted(places):
        edits.setdefault(file, []).append((start, end, word))
    for file in edits:
        if file not in project.texts:
            raise RenameRefused(f"`{symbol.name}` also stands in {file}, which is not in this workspace")
    changed = {file: edited(project.texts[file], ours) for file, ours in edits.items()}
    for file, text in project.texts.items():
        if file not in changed and "import" not in text:
            continue
        before = compile_text(text, file, (), project.opened)
        after = compile_text(changed.get(file, text), file, (), {**project.opened, **changed})
        if after.errors > before.errors:
            first = next(d for d in after.diagnostics if d.severity == "error")
            where = "" if first.span.file == document.file else f" in {first.span.file}"
            raise RenameRefused(f"`{symbol.name}` cannot be called `{new_name}`: {first.message}{where}")
    return edits


def formatting(document: Document) -> list[types.TextEdit]:
    """Return the edit that lays the text out. Return None while it has syntax errors."""
    try:
        formatted = format_text(document.text, document.file)
    except SpecError:
        return []
    return [] if formatted == document.text else [types.TextEdit(document.whole, formatted)]


def fixes(document: Document, start: int, end: int) -> list[tuple[Diagnostic, str, list[types.TextEdit]]]:
    """Return (diagnostic, title, edits) of each fix for the diagnostics that touch `start` to `end`."""
    found = []
    for one in document.own_diagnostics:
        if one.fixes and one.span.start <= end and start <= one.span.end:
            places = [(document.range(fix.span.start, fix.span.end), fix.replacement) for fix in one.fixes]
            edits = [types.TextEdit(place, replacement) for place, replacement in places]
            found.append((one, one.hint or one.message, edits))
    return found
