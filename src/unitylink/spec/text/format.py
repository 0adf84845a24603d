# SPDX-License-Identifier: BSD-3-Clause
"""The formatter: one canonical layout, that of the paper's Fig. 1. It keeps every comment and the meaning.

It works on tokens and comments, not on the syntax tree. So it cannot lose text that it does not understand.
"""

from __future__ import annotations

import re

from unitylink.errors import SpecError

from ..report.diagnostics import Reporter, render
from ..source import MAX_BYTES, Source
from .lexer import Tokens
from .parser import parse

WIDTH = 110  # a longer statement continues in the next line, after a comma
_INDENT = "   "
_CONTINUATION = "      "  # added to the indent of a statement's further lines
_WORDS = ("name", "keyword", "number", "string")
_NEW_LINE = re.compile(r"\r\n?|\n")


def format_text(text: str, file: str = "<text>") -> str:
    r"""Return `text` in the canonical layout. Raises `SpecError` if it has syntax errors.

    >>> format_text("public led(){@on=0x10:WRITE( ID = 'LED' ,CRC);} // one\n")
    "public led() {\n   @on = 0x10: WRITE(ID='LED', CRC);\n}  // one\n"
    """
    if len(text) > MAX_BYTES:
        raise SpecError(f"{file}: the text is larger than {MAX_BYTES:,} bytes")
    reporter = Reporter(Source(file, text))
    _, tokens = parse(reporter)
    if reporter.failed:
        diagnostics = reporter.diagnostics()
        raise SpecError(render(diagnostics), diagnostics)
    return _Writer(text, tokens).run()


class _Writer:
    def __init__(self, text: str, tokens: Tokens) -> None:
        self.text = text
        self.tokens = tokens
        self.lines: list[list[str]] = []  # the parts of each line
        self.pieces: list[list[str]] = []  # words of the current line, which may be broken between two pieces
        self.in_statement = False
        self.continued = False  # true if the current line is not the first one of its statement
        self.depth = 0
        self.opened = False  # true if the line before opened a body
        self.brackets: list[bool] = []  # for each open bracket: is there a space after its commas?
        self.annotation = False  # true within an annotation before the statement
        self.first = ""  # first word of the statement
        # for each open body: does it belong to an enumeration or to packed bits?
        self.of_type: list[bool] = []
        self.head = False  # true if the statement has had no `:` yet, so that its `=` is a definition
        self.previous = ""  # the token before this one, or "" at the beginning of a statement
        self.before_previous = ""
        self.previous_kind = ""
        self.commented = False  # a comment stands between the token before and this one

    def run(self) -> str:
        count = self.tokens.kinds.index("end")
        items = [(start, end, -1) for start, end in self.tokens.comments]
        items += [(self.tokens.starts[i], self.tokens.ends[i], i) for i in range(count)]
        items.sort()
        last = 0
        for start, end, i in items:
            breaks = len(_NEW_LINE.findall(self.text, last, start))
            word = self.text[start:end]
            if i < 0:
                self._comment(_NEW_LINE.sub("\n", word.rstrip()), breaks)
            else:
                self._token(word, i, breaks)
            last = end
        return "".join("".join(line).rstrip(" ") + "\n" for line in self.lines)

    def _comment(self, word: str, breaks: int) -> None:
        if self.in_statement:
            to_the_end = word.startswith("//")
            gap = "  " if to_the_end else " "
            self._piece((gap if self.pieces else "") + word)
            self.commented = True
            if to_the_end:
                self._flush()
                self.continued = True
        elif breaks == 0 and self.lines:
            self.lines[-1].append("  " + word)
        else:
            self._blank_line(breaks)
            self._add(_INDENT * self.depth + word)

    def _token(self, word: str, i: int, breaks: int) -> None:
        kind = self.tokens.kinds[i]
        if kind == "}":
            if self.in_statement and self.of_type and self.of_type[-1]:
                self._end_statement()  # the last `;` of an enumeration may be missing
            if not self.in_statement:
                self.depth -= 1
                if self.of_type:
                    self.of_type.pop()
                self._add("}")
                return
        if not self.in_statement:
            self._blank_line(breaks)
            self.in_statement = self.head = True
            self.annotation = kind == "@" and self.tokens.kinds[i + 2] == "("
            self.first = word
            self.previous = self.before_previous = self.previous_kind = ""
        if self.commented or self._space_before(word, i):
            word = " " + word
        self.commented = False
        self._piece(word)
        self._note(word.strip(), i)
        if kind in (";", "{"):
            self._end_statement()
            self.opened = kind == "{"
            self.depth += self.opened
            if self.opened:
                self.of_type.append(self.first in ("enum", "open", "bits"))
        elif self.annotation and kind == ")" and not self.brackets:
            self._end_statement()

    def _end_statement(self) -> None:
        self._flush()
        self.in_statement = self.continued = self.annotation = False

    def _note(self, word: str, i: int) -> None:
        """Remember the facts that decide about the spaces after this token."""
        kind = self.tokens.kinds[i]
        if kind == "(":
            self.brackets.append(self._is_spaced(i))
        elif kind == "[":
            self.brackets.append(False)
        elif kind in (")", "]") and self.brackets:
            self.brackets.pop()
        elif kind == ":":
            self.head = False
        self.before_previous, self.previous, self.previous_kind = self.previous, word, kind

    def _is_spaced(self, i: int) -> bool:
        """Is there a space after the commas of the bracket that opens at token `i`?"""
        if self.annotation or self.first == "link" or self.previous in ("TOSNET", "READ", "WRITE"):
            return True
        if self.previous in ("@", "=", "fixed", "ufixed", "ALL"):
            return False
        if self.depth > 0 and self.previous != "PUBLISH":
            return True
        # a head, or PUBLISH, has the layout of the published language if it has nothing else
        kinds = self.tokens.kinds
        behind = i
        while kinds[behind] not in (")", ";", "{", "}", "end"):
            behind += 1
        return ":" in kinds[i:behind] or "=" in kinds[i:behind]

    def _space_before(self, word: str, i: int) -> bool:
        kind, previous = self.tokens.kinds[i], self.previous
        if previous == ":" or (kind in _WORDS and self.previous_kind in (*_WORDS, ")")):
            return True
        if previous == ",":
            return self.brackets[-1] if self.brackets else True
        if previous == "=" or kind == "=":
            in_head = len(self.brackets) == 1 and self.depth == 0 and self.brackets[0]
            return (self.head and not self.brackets) or (in_head and self._is_head())
        if self.of_type and self.of_type[-1] and not self.brackets:
            return "@" in (kind, previous) or kind == "("
        if self.first == "link" and kind == "(":
            return not self.brackets
        if previous == "@":  # `@ (0x1,0x2)` and `@ 0x1` bind addresses, `@l=0x1` names them
            names = kind == "name" and (self.tokens.kinds[i + 1] == "=" or self.before_previous != ")")
            return not names and kind != "keyword"
        return kind == "{" or (kind == "@" and previous == ")")

    def _is_head(self) -> bool:
        """Is this the head of a constructor, where parameters have types and defaults?"""
        return not self.annotation and self.first != "link"

    def _piece(self, word: str) -> None:
        """Add to the line. It may be broken only after a comma of the outermost bracket."""
        inner = len(self.brackets) > 1
        if self.pieces and not (self.pieces[-1][-1] == "," and word != "," and not inner):
            self.pieces[-1].append(word)
        else:
            self.pieces.append([word])

    def _flush(self) -> None:
        indent = _INDENT * self.depth
        line = indent + (_CONTINUATION if self.continued else "")
        empty = True
        for words in self.pieces:
            piece = "".join(words)
            if not empty and len(line) + len(piece) > WIDTH:
                self._add(line)
                line = indent + _CONTINUATION
                empty = True
            line += piece.lstrip() if empty else piece
            empty = False
        if not empty:
            self._add(line)
        self.pieces = []

    def _blank_line(self, breaks: int) -> None:
        """Reduce several blank lines to one. Remove them at the beginning of the file or of a body."""
        if breaks > 1 and self.lines and not self.opened:
            self._add("")

    def _add(self, line: str) -> None:
        self.lines.append([line])
        self.opened = False
