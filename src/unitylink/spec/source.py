# SPDX-License-Identifier: BSD-3-Clause
"""The texts of a spec's files: their decoding, and the place of an offset in them.

All files of one compilation share one space of offsets. Each file begins where the one before it ends. So a
single number gives a place, in whichever file that is.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from pathlib import PurePath

from .model import Span

MAX_BYTES = 1024 * 1024  # limits time and memory of a compilation: 10,000 statements of 100 characters

_LINE_END = re.compile(r"\r\n?|\n")
_EXCERPT_BEFORE = 70  # characters of a long line that are kept before and after a caret
_EXCERPT_AFTER = 90


class Source:
    """The text of one file, with a line map. Lines and columns count from 1, offsets from `base`.

    >>> Source("a.ul", "ab\\ncd", 100).span(104, 105)
    Span(file='a.ul', line=2, column=2, start=4, end=5)
    """

    def __init__(self, file: str, text: str, base: int = 0) -> None:
        self.file = file
        self.text = text
        self.base = base
        self._starts = [0, *(match.end() for match in _LINE_END.finditer(text))]

    @property
    def stem(self) -> str:
        """The file's name without folders and suffix, as a valid name: `my-robot.ul` gives `my_robot`."""
        stem = re.sub(r"[^A-Za-z_0-9]", "_", PurePath(self.file).stem).strip("_") or "spec"
        return f"_{stem}" if stem[0].isdigit() else stem

    def line_of(self, offset: int) -> int:
        """Return the line that contains `offset`."""
        return bisect_right(self._starts, offset - self.base)

    def span(self, start: int, end: int) -> Span:
        """Return the span of the characters from `start` to before `end`.

        It counts from the beginning of the file.
        """
        start, end = start - self.base, end - self.base
        line = bisect_right(self._starts, start)
        return Span(self.file, line, start - self._starts[line - 1] + 1, start, end)

    def excerpt(self, start: int, end: int) -> tuple[str, int, int]:
        """Return (the line around `start` in a form for terminals, the caret's offset in it, its length)."""
        start, end = start - self.base, end - self.base
        line = bisect_right(self._starts, start)
        first = self._starts[line - 1]
        last = self._starts[line] if line < len(self._starts) else len(self.text)
        left = max(first, start - _EXCERPT_BEFORE)
        right = min(last, start + _EXCERPT_AFTER)
        shown = self.text[left:right].rstrip("\r\n")
        # A control character or an escape sequence of a file must not reach a terminal. The widths must not
        # change.
        shown = "".join(c if c.isprintable() else " " if c == "\t" else "\ufffd" for c in shown)
        caret = start - left
        return shown, caret, max(1, min(end - start, len(shown) - caret))


class Sources:
    """The files of one compilation. The first is the main file."""

    def __init__(self, first: Source) -> None:
        self._all = [first]
        self._bases = [first.base]
        self._library: int | None = None  # where the files of the component library begin

    @property
    def first(self) -> Source:
        return self._all[0]

    def __len__(self) -> int:
        return len(self._all)

    def add(self, file: str, text: str, *, library: bool = False) -> Source:
        """Add a file after the last one. Files of the library come last."""
        last = self._all[-1]
        source = Source(file, text, last.base + len(last.text) + 1)
        if library and self._library is None:
            self._library = source.base
        self._all.append(source)
        self._bases.append(source.base)
        return source

    def at(self, offset: int) -> Source:
        """Return the file that contains an offset."""
        return self._all[bisect_right(self._bases, offset) - 1]

    def text(self, start: int, end: int) -> str:
        """Return the text between two offsets."""
        source = self.at(start)
        return source.text[start - source.base : end - source.base]

    def in_library(self, offset: int) -> bool:
        """Is an offset in a file of the component library?"""
        return self._library is not None and offset >= self._library

    def offset(self, span: Span) -> int:
        """Return the start of a span as an offset among all files."""
        if span.file == self.first.file:
            return span.start
        return next(one.base for one in self._all if one.file == span.file) + span.start

    def line_of(self, offset: int) -> int:
        """Return the line that contains `offset`, in its file."""
        return self.at(offset).line_of(offset)

    def span(self, start: int, end: int) -> Span:
        """Return the span of the characters from `start` to before `end`."""
        return self.at(start).span(start, end)

    def excerpt(self, start: int, end: int) -> tuple[str, int, int]:
        """Return `Source.excerpt` of these characters."""
        return self.at(start).excerpt(start, end)


def decode(data: bytes) -> tuple[str, int | None]:
    """Decode UTF-8. Return (text, None), or (text before the first wrong byte, its offset in characters)."""
    try:
        return data.decode("utf-8"), None
    except UnicodeDecodeError as error:
        text = data[: error.start].decode("utf-8")
        return text, len(text)
