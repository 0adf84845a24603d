# SPDX-License-Identifier: BSD-3-Clause
"""Answers that change a text: rename, formatting, fixes. None of them makes a right spec wrong."""

from __future__ import annotations

import re

from lsprotocol import types

from unitylink.errors import SpecError
from unitylink.spec import Diagnostic, compile_text, format_text
from unitylink.spec.lexer import KEYWORDS, MAX_NAME

from .document import Document

_NAME = re.compile(rf"[A-Za-z_][A-Za-z_0-9]{{0,{MAX_NAME - 1}}}")


class RenameRefused(Exception):
    """Why a name cannot be changed to another."""


def rename(document: Document, offset: int, new_name: str) -> list[types.TextEdit]:
    """Return the edits that give the symbol at `offset` another name, everywhere it is used."""
    found = document.symbols.at(offset)
    if found is None:
        raise RenameRefused("there is no name here")
    symbol, _ = found
    elsewhere = next((place for place in symbol.places if not document.is_own(place)), None)
    if elsewhere is not None:
        file = document.symbols.sources.at(elsewhere.start).file
        raise RenameRefused(f"`{symbol.name}` is declared in {file}, which other specs may import")
    new_name = new_name.removeprefix("^")
    if not _NAME.fullmatch(new_name):
        raise RenameRefused(f"`{new_name}` is not a name: names are made of A-Z a-z 0-9 _")
    word = f"^{new_name}" if new_name in KEYWORDS else new_name
    text = document.text
    for place in reversed(symbol.places):
        text = text[: place.start] + word + text[place.end :]
    after = compile_text(text, document.file)
    if after.errors > document.result.errors:
        first = next(d for d in after.diagnostics if d.severity == "error")
        raise RenameRefused(f"`{symbol.name}` cannot be called `{new_name}`: {first.message}")
    return [types.TextEdit(document.range(place.start, place.end), word) for place in symbol.places]


def formatting(document: Document) -> list[types.TextEdit]:
    """Return the edit that lays the text out; none while it has syntax errors."""
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
