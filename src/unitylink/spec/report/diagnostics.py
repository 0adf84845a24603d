# SPDX-License-Identifier: BSD-3-Clause
"""Diagnostics: what is wrong in a spec, where it is, what to do about it, and how this is shown."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from typing import NamedTuple
from unicodedata import combining, east_asian_width

from ..model import Span
from ..source import Source, Sources
from .codes import CODES
from .suggest import nearest

KEPT = 1000  # the most diagnostics that one compilation keeps
SHOWN = 100  # the most diagnostics that `render` prints
_SUGGESTIONS = 20  # the most names for which one compilation looks for similar ones

_RED, _YELLOW, _BLUE, _BOLD, _OFF = "\x1b[1;31m", "\x1b[1;33m", "\x1b[1;34m", "\x1b[1m", "\x1b[0m"


@dataclass(frozen=True)
class Label:
    """Another place of a diagnostic, such as "first declared here"."""

    span: Span
    text: str
    excerpt: str
    caret: int
    width: int


@dataclass(frozen=True)
class Fix:
    """A fix that a program may make. It puts `replacement` in place of `span`.

    An empty span means an insertion.
    """

    span: Span
    replacement: str


@dataclass(frozen=True)
class Diagnostic:
    """One mistake ("error") or doubt ("warning") in a spec.

    `code` never changes, and `hint` says what to do.

    `labels` are further places. `fixes`, made together, mend it without a change of meaning.
    """

    severity: str
    code: str
    message: str
    span: Span
    hint: str = ""
    excerpt: str = ""  # the source line, or the part of a long one around the caret
    caret: int = 0  # offset of the caret in `excerpt`
    width: int = 1  # length of the caret
    labels: tuple[Label, ...] = ()
    fixes: tuple[Fix, ...] = ()

    def to_json(self) -> dict[str, object]:
        """Return the form that `--json` prints."""
        return {
            "severity": self.severity,
            "code": self.code,
            "file": self.span.file,
            "line": self.span.line,
            "column": self.span.column,
            "message": self.message,
            "hint": self.hint,
            "labels": [
                {"file": at.file, "line": at.line, "column": at.column, "text": label.text}
                for label in self.labels
                for at in [label.span]
            ],
            "fixes": [
                {"file": at.file, "start": at.start, "end": at.end, "replacement": fix.replacement}
                for fix in self.fixes
                for at in [fix.span]
            ],
        }


# (first offset, second offset, text): the text replaces the characters between the offsets
Edit = tuple[int, int, str]


class Advice(NamedTuple):
    """What to do about a mistake: a text for a person and, if they are certain, fixes for a program."""

    text: str
    fixes: tuple[Edit, ...] = ()

    def __bool__(self) -> bool:
        return bool(self.text)


class Reporter:
    """Collects the diagnostics of one compilation, each only once for each place."""

    def __init__(self, source: Source) -> None:
        self.sources = Sources(source)
        self.failed = False  # true after an error was reported
        # the component that is being expanded, in the user's text
        self.placed_at: tuple[int, int] | None = None
        self._found: dict[tuple[str, int], Diagnostic] = {}
        self._suggestions = _SUGGESTIONS

    def report(
        self,
        code: str,
        start: int,
        end: int,
        message: str,
        hint: str | Advice = "",
        *,
        labels: Iterable[tuple[int, int, str]] = (),
    ) -> None:
        """Add a diagnostic about the characters `start` to `end`. Each code is reported once at each place.

        `labels` are (start, end, text) of further places. A mistake inside the component library is reported
        at the place that uses the component, because users cannot mend the library.
        """
        start, end = self.place(start, end)
        severity = CODES[code].severity
        self.failed = self.failed or severity == "error"
        if (code, start) in self._found:
            return
        if self.full:
            return
        source = self.sources
        advice = Advice(hint) if isinstance(hint, str) else hint
        self._found[code, start] = Diagnostic(
            severity,
            code,
            message,
            source.span(start, end),
            advice.text,
            *source.excerpt(start, end),
            tuple(Label(source.span(a, b), text, *source.excerpt(a, b)) for a, b, text in labels),
            tuple(Fix(source.span(a, b), replacement) for a, b, replacement in advice.fixes),
        )

    def place(self, start: int, end: int) -> tuple[int, int]:
        """Return the place that is reported for these characters.

        If they are in a component's file, it is the place that uses the component.
        """
        return self.placed_at if self.placed_at and self.sources.in_library(start) else (start, end)

    @contextmanager
    def using(self, start: int, end: int) -> Iterator[None]:
        """Note that a component is expanded next, and that these characters use it."""
        before, self.placed_at = self.placed_at, self.placed_at or (start, end)
        try:
            yield
        finally:
            self.placed_at = before

    @property
    def full(self) -> bool:
        """Whether no more diagnostics are kept. Then it is useless to look for more."""
        return len(self._found) >= KEPT

    def did_you_mean(
        self, name: str, candidates: Iterable[str], otherwise: str = "", at: tuple[int, int] | None = None
    ) -> Advice:
        """Advise the candidate that is most similar to `name`. If there is none, advise `otherwise`.

        `at` is the place for it.
        """
        self._suggestions -= 1
        found = nearest(name, candidates) if self._suggestions >= 0 else None
        if found is None:
            return Advice(otherwise)
        return Advice(f"did you mean `{found}`?", () if at is None else ((*at, found),))

    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """Return all diagnostics in the order of the text.

        Those of the first file come before those of its imports.
        """
        ordered = [self._found[key] for key in sorted(self._found, key=lambda key: (key[1], key[0]))]
        if self.full:
            message = f"there are more than {KEPT:,} diagnostics; the rest is not listed"
            severity = "error" if self.failed else "warning"
            hint = "correct those above and check again"
            ordered.append(Diagnostic(severity, "UL000", message, ordered[-1].span, hint))
        return tuple(ordered)


def render(diagnostics: Sequence[Diagnostic], *, color: bool = False) -> str:
    """Return the report for a person: each diagnostic with its line and a caret, then a summary line.

    At most 100 are shown. Then comes the number of the others. Without diagnostics the report is empty.
    """
    if not diagnostics:
        return ""
    parts = [_render_one(diagnostic, color) for diagnostic in diagnostics[:SHOWN]]
    if len(diagnostics) > SHOWN:
        parts.append(f"... and {len(diagnostics) - SHOWN:,} more\n")
    parts.append(summary(diagnostics))
    return "\n".join(parts) + "\n"


def summary(diagnostics: Sequence[Diagnostic]) -> str:
    """Return "2 errors, 1 warning"."""
    errors = sum(1 for diagnostic in diagnostics if diagnostic.severity == "error")
    counts = [(errors, "error"), (len(diagnostics) - errors, "warning")]
    return ", ".join(f"{n:,} {word}{'' if n == 1 else 's'}" for n, word in counts if n) or "no errors"


def _columns(text: str) -> int:
    """Return how many columns of a terminal `text` needs. Wide characters need two, combining ones none."""
    if text.isascii():
        return len(text)
    return sum(0 if combining(c) else 2 if east_asian_width(c) in "WF" else 1 for c in text)


def _render_one(diagnostic: Diagnostic, color: bool) -> str:
    accent, blue, bold, off = ("", "", "", "")
    if color:
        accent, blue, bold, off = (_RED if diagnostic.severity == "error" else _YELLOW), _BLUE, _BOLD, _OFF
    span = diagnostic.span
    margin = " " * max(len(str(one.line)) for one in (span, *(label.span for label in diagnostic.labels)))
    lines = [
        f"{accent}{diagnostic.severity}[{diagnostic.code}]{off}{bold}: {diagnostic.message}{off}",
        f"{margin}{blue}-->{off} {span.file}:{span.line}:{span.column}",
    ]
    if diagnostic.excerpt:
        lines.append(f"{margin} {blue}|{off}")
        place = Label(span, "", diagnostic.excerpt, diagnostic.caret, diagnostic.width)
        lines += _snippet(place, "^", margin, (accent, blue, off))
    file = span.file
    for label in diagnostic.labels:
        at = label.span
        other = f"{margin}{blue}:::{off} {at.file}:{at.line}:{at.column}"
        lines.append(other if at.file != file else f"{margin} {blue}:{off}")
        file = at.file
        lines += _snippet(label, "-", margin, (blue, blue, off))
    if diagnostic.hint:
        lines.append(f"{margin} {blue}={off} {bold}help{off}: {diagnostic.hint}")
    return "\n".join(lines) + "\n"


def _snippet(place: Label, mark: str, margin: str, colors: tuple[str, str, str]) -> list[str]:
    """Return a line of the source, with marks under a part of it."""
    accent, blue, off = colors
    before, under = place.excerpt[: place.caret], place.excerpt[place.caret : place.caret + place.width]
    marks = " " * _columns(before) + mark * max(1, _columns(under))
    text = f" {place.text}" if place.text else ""
    return [
        f"{blue}{place.span.line:<{len(margin)}} |{off} {place.excerpt}",
        f"{margin} {blue}|{off} {accent}{marks}{text}{off}",
    ]
