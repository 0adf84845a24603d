# SPDX-License-Identifier: BSD-3-Clause
"""One open text: what the server knows about it, and conversion of its offsets to the client's lines and
columns.
"""

from __future__ import annotations

import re
from bisect import bisect_right
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

from lsprotocol import types
from pygls.workspace import PositionCodec

from unitylink.spec import Diagnostic, Result, Spec, compile_text
from unitylink.spec.compile import search_path
from unitylink.spec.meaning.symbols import Symbols, find_symbols
from unitylink.spec.text.syntax import Name

_LINE_END = re.compile(r"\r\n?|\n")


def line_starts(text: str) -> list[int]:
    """Return the offsets at which the lines of a text begin."""
    return [0, *(match.end() for match in _LINE_END.finditer(text))]


def range_in(text: str, start: int, end: int, codec: PositionCodec) -> types.Range:
    """Return the client's range of characters, for a text that is not a document."""
    starts = line_starts(text)
    return types.Range(*(_position(text, starts, offset, codec) for offset in (start, end)))


def _position(text: str, starts: list[int], offset: int, codec: PositionCodec) -> types.Position:
    line = bisect_right(starts, offset) - 1
    return types.Position(line, codec.client_num_units(text[starts[line] : offset]))


class Document:
    """One version of a text.

    `spec` is its model. While this version has errors, it is the model of the last version without errors.
    """

    def __init__(
        self,
        text: str,
        file: str,
        codec: PositionCodec,
        before: Document | None = None,
        opened: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        self.text = text
        self.file = file
        self.codec = codec
        self.opened = opened  # the editor's texts of other files, by real path
        self.result: Result = compile_text(text, file, (), opened)
        self.spec: Spec | None = self.result.spec or (before.spec if before else None)
        self._starts = line_starts(text)

    @cached_property
    def symbols(self) -> Symbols:
        """The symbols. They are found at the first request, because many edits are followed by none."""
        return find_symbols(self.text, self.file, search_path(), self.opened)

    def position(self, offset: int) -> types.Position:
        """Return the client's position of a character. Clients count in units of their own encoding."""
        return _position(self.text, self._starts, offset, self.codec)

    def range(self, start: int, end: int) -> types.Range:
        """Return the client's range of the characters from `start` to before `end`."""
        return types.Range(self.position(start), self.position(end))

    def location(self, uri: str, place: Name) -> types.Location:
        """Return where a name stands: in this document (`uri`) or in a file that it imports."""
        source = self.symbols.sources.at(place.start)
        if source is self.symbols.sources.first:
            return types.Location(uri, self.range(place.start, place.end))
        inside = range_in(source.text, place.start - source.base, place.end - source.base, self.codec)
        return types.Location(Path(source.file).resolve().as_uri(), inside)

    def offset(self, position: types.Position) -> int:
        """Return the character at a client's position. A position beyond the text means its end."""
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
    def own_diagnostics(self) -> list[Diagnostic]:
        """The diagnostics about this document, and not about a file it imports."""
        return [one for one in self.result.diagnostics if one.span.file == self.file]

    @property
    def whole(self) -> types.Range:
        """The range of the whole text."""
        return self.range(0, len(self.text))
