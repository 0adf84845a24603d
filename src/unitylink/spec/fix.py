# SPDX-License-Identifier: BSD-3-Clause
"""Make the fixes that diagnostics offer, if they really mend something.

>>> mended = fix_text("public a() { @x = 0x1: READ() }")
>>> mended.text, [diagnostic.code for diagnostic in mended.made]
('public a() { @x = 0x1: READ(); }', ['UL011'])
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from .compile import Result, compile_text
from .report.diagnostics import Diagnostic, Edit

_ROUNDS = 20  # a fix may reveal another mistake
_TRIALS = 50  # the most diagnostics whose fixes are tried one by one, if all together did not help
_LAST_SYNTAX_CODE = "UL019"


@dataclass(frozen=True)
class Fixed:
    """A text after fixes. `made` are the mended diagnostics. `result` has the remaining ones."""

    text: str
    made: tuple[Diagnostic, ...]
    result: Result


def fix_text(text: str, file: str = "<text>") -> Fixed:
    """Return `text` with the fixes of its diagnostics made. It has fewer mistakes, or is unchanged.

    Each step is compiled. Fixes that do not leave fewer mistakes are not made.
    """
    result = compile_text(text, file)
    made: list[Diagnostic] = []
    for _ in range(_ROUNDS):
        fixable = [d for d in result.diagnostics if d.fixes and all(f.span.file == file for f in d.fixes)]
        step = _try(text, file, result, _apart(fixable))
        if step is None:
            trials = (_try(text, file, result, [one]) for one in fixable[:_TRIALS])
            step = next((one for one in trials if one is not None), None)
        if step is None:
            break
        text, result = step.text, step.result
        made += step.made
    return Fixed(text, tuple(made), result)


def edited(text: str, edits: Iterable[Edit]) -> str:
    """Return a text after the edits. They do not overlap.

    >>> edited("a() b()", [(0, 1, "cell"), (4, 5, "^READ")])
    'cell() ^READ()'
    """
    for start, end, replacement in sorted(edits, reverse=True):
        text = text[:start] + replacement + text[end:]
    return text


def _try(text: str, file: str, before: Result, chosen: list[Diagnostic]) -> Fixed | None:
    mended = edited(text, {(f.span.start, f.span.end, f.replacement) for d in chosen for f in d.fixes})
    if mended == text:
        return None
    after = compile_text(mended, file)
    return Fixed(mended, tuple(chosen), after) if _faults(after) < _faults(before) else None


def _faults(result: Result) -> tuple[int, int, int]:
    """Return a measure of how wrong a text is.

    Syntax comes first, because mending it may reveal mistakes of meaning.
    """
    syntax = sum(1 for d in result.diagnostics if d.severity == "error" and d.code <= _LAST_SYNTAX_CODE)
    return syntax, result.errors, len(result.diagnostics)


def _apart(diagnostics: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Return those diagnostics whose fixes do not touch the same characters."""
    chosen: list[Diagnostic] = []
    taken: list[tuple[int, int]] = []
    for one in diagnostics:
        spans = [(fix.span.start, fix.span.end) for fix in one.fixes]
        if not any(start <= b and a <= end for start, end in spans for a, b in taken):
            chosen.append(one)
            taken += spans
    return chosen
