# SPDX-License-Identifier: BSD-3-Clause
"""What the server knows of one open text, and how its offsets become a client's lines and columns."""

from __future__ import annotations

import re
from bisect import bisect_right
from functools import cached_property

from lsprotocol import types
from pygls.workspace import PositionCodec

from unitylink.spec import Result, Spec, compile_text
from unitylink.spec.symbols import Symbols, find_symbols

_LINE_END = re.compile(r"\r\n?|\n")


class Document:
    """One version of a text; `spec` is its model or, while it has errors, that of the last one without."""

    def __init__(self, text: str, file: str, codec: PositionCodec, before: Document | None = None) -> None:
        self.text = text
        self.file = file
        self.codec = codec
        self.result: Result = compile_text(text, file)
        self.spec: Spec | None = self.result.spec or (before.spec if before else None)
        self._starts = [0, *(match.end() for match in _LINE_END.finditer(text))]

    @cached_property
    def symbols(self) -> Symbols:
        """The symbols, found when first asked for: not every edit is followed by a question."""
        return find_symbols(self.text, self.file)

    def position(self, offset: int) -> types.Position:
        """Return the client's position of a character: clients count in units of their own encoding."""
        line = bisect_right(self._starts, offset) - 1
        before = self.text[self._starts[line] : offset]
        return types.Position(line, self.codec.client_num_units(before))

    def range(self, start: int, end: int) -> types.Range:
        """Return the client's range of the characters from `start` up to, without, `end`."""
        return types.Range(self.position(start), self.position(end))

    def offset(self, position: types.Position) -> int:
        """Return the character a client's position means; one beyond the text means its end."""
        if position.line >= len(self._starts):
            return len(self.text)
        start = self._starts[position.line]
        end = self._starts[position.line + 1] if position.line + 1 < len(self._starts) else len(self.text)
        units = 0
        for offset in range(start, end):
            if units >= position.character or self.text[offset] in "\r\n":
                return offset
            units += self.codec.client_num_units(self.text[offset])
        return end

    @property
    def whole(self) -> types.Range:
        """The range of the whole text."""
        return self.range(0, len(self.text))
