# SPDX-License-Identifier: BSD-3-Clause
"""A place in the tokens, and its movements: expect, look ahead, report, skip mistakes."""

from __future__ import annotations

from bisect import bisect_left

from ..report.diagnostics import Advice, Reporter
from ..source import Source
from .lexer import Tokens
from .syntax import Name

# no member begins with these
_WITHIN = ("READ", "WRITE", "signed", "ID", "CRC", "PUBLISH", "CTRL", "COMM", "BASE")
_AHEAD = 64  # the most tokens of a look-ahead; without a limit, many open brackets would take quadratic time
_NOTES_AHEAD = 1024  # of one over annotations: those of a device on SPI are many
LINK_KINDS = ("TOSNET", "MEMORY", "DOUBLE_BUFFER", "FIFO")
ACCESS_WORDS = ("READ", "WRITE", "READWRITE", "W1C", "PULSE", "READCLEAR")


_IN_HEAD = ("name", "keyword", "number", "string", ",", ":", "=", "+", "-", "*")  # of parameters


class Panic(Exception):
    """The next tokens cannot be read. A diagnostic has been given. This never leaves the file."""


class Cursor:
    """The place of the parser. `broken` tells whether the current member has a mistake."""

    def __init__(self, source: Source, reporter: Reporter, tokens: Tokens) -> None:
        self.source = source
        self.reporter = reporter
        self.tokens = tokens
        self.kinds = tokens.kinds
        self.texts = tokens.texts
        self.i = 0
        self.broken = False  # true if the current member has a mistake that leaves its meaning open
        self.first = 0  # the first token of the current member or head

    # --- words ----------------------------------------------------------------------------------------------

    def name(self, what: str) -> Name:
        kind = self.kinds[self.i]
        if kind not in ("name", "keyword"):
            raise self.unexpected(what)
        text = self.texts[self.i]
        if kind == "keyword":
            at = self.tokens.starts[self.i]
            advice = self.replace(f"as a name it is written `^{text}`", at, at, "^")
            self.report("UL014", self.i, f"`{text}` is a keyword, not a name", advice)
        self.i += 1
        return Name(text, self.tokens.starts[self.i - 1], self.tokens.ends[self.i - 1])

    def names(self, what: str) -> list[Name]:
        """Read names and the `)` after them. The `(` has already been read."""
        if self.accept(")"):
            return []
        names = [self.name(what)]
        while not self.accept(")"):
            self.expect(",", "`,` or `)`")
            names.append(self.name(what))
        return names

    def accept(self, kind: str) -> bool:
        found = self.kinds[self.i] == kind
        self.i += found
        return found

    def expect(self, kind: str, what: str) -> None:
        if self.kinds[self.i] != kind:
            raise self.unexpected(what)
        self.i += 1

    def semicolon(self) -> None:
        if self.accept(";"):
            return
        ended = self.kinds[self.i] in ("}", "end") or self.on_new_line()
        if ended or self.at_member() or self.at_head():
            if self.kinds[self.i] == "}" and self.at_member(self.i + 1):
                self.unexpected("`;`")
                self.broken = True
                self.i += 1  # it stands for the `;`, and the body continues
                return
            if not self.faulty():
                end = self.tokens.ends[self.i - 1]
                self.reporter.report(
                    "UL011", end, end, "`;` is missing here", self.replace("add `;`", end, end, ";")
                )
            return
        raise self.unexpected("`;`")

    # --- looking ahead, reporting, skipping -----------------------------------------------------------------

    def at_head(self, i: int | None = None, *, keyword: bool = False) -> bool:
        """Does a constructor begin here, or at token `i`: `public`, or `name(names)` and `:` or `{`?

        Annotations may stand before it. With `keyword`, a constructor whose name is a keyword by mistake
        counts too.
        """
        kinds = self.kinds
        i = self.behind_annotations(self.i if i is None else i)
        if kinds[i] == "keyword" and self.texts[i] == "public":
            return True
        if (kinds[i] != "name" and not (keyword and kinds[i] == "keyword")) or kinds[i + 1] != "(":
            return False
        i += 2
        last = i + _AHEAD
        while i < last and kinds[i] in _IN_HEAD:
            i += 1
        while kinds[i] in ("name", ","):  # a classic head may have any length
            i += 1
        return kinds[i] == ")" and kinds[i + 1] in (":", "{")

    def at_member(self, i: int | None = None) -> bool:
        """Does a member begin here, or at token `i`, which cannot be the rest of another one?"""
        kinds = self.kinds
        if i is None:
            i = self.i
        if self.at_annotation(i):
            return not self.at_head(i)
        if kinds[i] == "@" and kinds[i + 1] == "name":
            return kinds[i + 2] in (":", "[") or (kinds[i + 2] == "=" and self._addressed_by(i + 3))
        if self.at_link_kind(i):
            return not self.at_head(i)  # FIFO may be the name of a constructor
        if kinds[i] == "name" and kinds[i + 1] == "[":
            i = self._behind_index(i + 1) - 1
            return kinds[i + 1] == ":"
        # `joint: @` is a head without parameters
        return kinds[i] == "name" and (kinds[i + 1] == "=" or (kinds[i + 1] == ":" and kinds[i + 2] != "@"))

    def at_annotation(self, i: int) -> bool:
        """Is token `i` the beginning of `@name(…)`?"""
        return self.kinds[i] == "@" and self.kinds[i + 1] == "name" and self.kinds[i + 2] == "("

    def behind_annotations(self, i: int) -> int:
        """Return the first token from `i` on that belongs to no annotation.

        The search goes only so far ahead.
        """
        last = i + _NOTES_AHEAD
        while i < last and self.at_annotation(i):
            i = self.behind_bracket(i + 2)
        return i

    def behind_bracket(self, i: int) -> int:
        """Return the token after the `)` that closes the `(` at token `i`, or one where the `)` cannot be."""
        depth = 0
        for j in range(i, min(i + _AHEAD, len(self.kinds) - 5)):
            depth += (self.kinds[j] == "(") - (self.kinds[j] == ")")
            if depth == 0:
                return j + 1
            if self.kinds[j] in (";", "{", "}"):
                return j
        return i

    def _addressed_by(self, i: int) -> bool:
        """Is the expression at token `i` an element's address, so that a `:` follows it?"""
        kinds = self.kinds
        if kinds[i] == "number" and kinds[i + 1] == ":":
            return True
        for j in range(i, i + _AHEAD):
            if kinds[j] in (";", ",", "@", "{", "}", "end") or self.on_new_line(j):
                return False
            if kinds[j] == ":":
                return True
        return False

    def _behind_index(self, i: int) -> int:
        """Return the token after the `]` that closes the `[` at token `i`, or one that is no `:`."""
        for j in range(i, i + _AHEAD):
            if self.kinds[j] == "]":
                return j + 1
            if self.kinds[j] in (";", "{", "}", "end"):
                return j
        return i

    def at_link_kind(self, i: int) -> bool:
        """Does `TOSNET(…)`, `MEMORY(…)`, `DOUBLE_BUFFER(…)` or `FIFO(…)` begin at token `i`?

        Of these words, only TOSNET is a keyword.
        """
        if self.texts[i] not in LINK_KINDS or self.kinds[i + 1] != "(":
            return False
        if self.kinds[i] == "keyword":
            return self.texts[i] == "TOSNET"
        return self.kinds[i] == "name" and not self.at_head(i)

    def at_nested(self) -> bool:
        """Is this a whole constructor inside of a body, so that members follow its closing brace?"""
        if not self.at_head() or self.at_public_member():
            return False
        i = self.i
        while self.kinds[i] not in ("{", "end"):
            i += 1
        i += self.kinds[i] == "{"
        while self.kinds[i] not in ("{", "}", "end"):
            i += 1
        return self.kinds[i] == "}" and (self.kinds[i + 1] == "}" or self.at_member(i + 1))

    def at_public_member(self) -> bool:
        """Return whether this is a `public` before something that can only be a member."""
        kinds, i = self.kinds, self.i
        if kinds[i] != "keyword":
            return False
        return kinds[i + 1] == "@" or (kinds[i + 1] == "name" and kinds[i + 2] in (":", "="))

    def at_binding(self, i: int) -> bool:
        """Do the addresses of an expansion begin with token `i`?"""
        kinds = self.kinds
        named = kinds[i + 1] == "name" and kinds[i + 2] == "="
        return kinds[i] == "@" and (kinds[i + 1] == "(" or (named and kinds[i + 3] == "("))

    def on_new_line(self, i: int | None = None) -> bool:
        if i is None:
            i = self.i
        if i == 0:
            return True
        base = self.source.base
        between = self.source.text[self.tokens.ends[i - 1] - base : self.tokens.starts[i] - base]
        return "\n" in between or "\r" in between

    def faulty(self) -> bool:
        """Return whether the lexer found a mistake in the current text.

        Then a wrong token there is not reported again.
        """
        if self.kinds[self.i] == "end" and self.tokens.truncated:
            return True
        return self._fault_before(self.tokens.ends[self.i])

    def touched(self) -> bool:
        """The same as `faulty`, for the text before the next token."""
        return self._fault_before(self.tokens.ends[self.i - 1] if self.i else 0)

    def _fault_before(self, end: int) -> bool:
        faults = self.tokens.faults
        before = min(self.first, self.i) - 1
        at = bisect_left(faults, self.tokens.ends[before] if before >= 0 else 0)
        return at < len(faults) and faults[at] < end

    def place(self, i: int) -> tuple[int, int]:
        """Return where token `i` starts and ends."""
        return self.tokens.starts[i], self.tokens.ends[i]

    @staticmethod
    def replace(text: str, start: int, end: int, replacement: str) -> Advice:
        """Advise `replacement` for the characters from `start` to `end`."""
        return Advice(text, ((start, end, replacement),))

    def report(self, code: str, i: int, message: str, hint: str | Advice) -> None:
        self.reporter.report(code, self.tokens.starts[i], self.tokens.ends[i], message, hint)

    def unexpected(self, what: str, hint: str | Advice = "", *, begins: bool = False) -> Panic:
        """Report that `what` was expected instead of the current token. Return the exception to raise.

        With `begins`, something begins at this token, so nothing is missing before it.
        """
        if self.faulty():
            return Panic()
        i = self.i
        kind, text = self.kinds[i], self.texts[i]
        found = {"end": "the end of the file", "string": "a string"}.get(kind, f"`{text[:40]}`")
        start, end = self.tokens.starts[i], self.tokens.ends[i]
        if i and (kind == "end" or (self.on_new_line() and not begins)):
            start = end = self.tokens.ends[i - 1]  # after the line in which it is missing
        if not hint and i and self.kinds[i - 1] == "," and kind in (")", ";", "{", "}"):
            hint = self.replace("remove the `,`", *self.place(i - 1), "")
        self.reporter.report("UL010", start, end, f"expected {what} but found {found}", hint)
        return Panic()

    def skip_member(self) -> None:
        """Move past the next `;`, or to a `}`, a head, or a line that starts like a member."""
        depth = sum((k in "({") - (k == ")") for k in self.kinds[self.first : self.i])
        first = self.i
        while (kind := self.kinds[self.i]) != "end":
            if kind in (";", "}") and not self._goes_on(depth > 0, self.i == first):
                self.i += kind == ";"
                return
            if self.on_new_line() and (self.at_head() or self.at_member()):
                return
            if kind == "keyword" and self.texts[self.i] == "public":
                return
            depth += (kind in "({") - (kind in ")}")
            self.i += 1

    def _goes_on(self, inside: bool, wrong: bool) -> bool:
        """Return whether the member continues after this `;` or `}` in the same line.

        Then this mark is the mistake.

        Within brackets (`inside`), everything belongs to the member, except the beginning of a constructor.
        `wrong` says that this token was not expected. Then a token that cannot begin anything belongs to the
        member, too.
        """
        i = self.i + 1
        kind = self.kinds[i]
        if kind in ("end", "}") or self.on_new_line(i) or self.at_member(i):
            return False
        if inside:
            self.i += 1
            head = self.at_head()
            self.i -= 1
            return not head
        if kind == "name":
            return wrong and self.kinds[self.i] == ";" and self.kinds[i + 1] == "("
        return wrong and (kind in ("(", ")", ",", ";", "number", "string") or self.texts[i] in _WITHIN)

    def skip_to_body(self) -> bool:
        """After a broken head, move to its members. Return False if there are none."""
        while (kind := self.kinds[self.i]) != "end":
            if kind in ("{", "}"):
                self.i += kind == "{"
                return True
            if self.on_new_line() and self.at_head():
                return False
            if self.on_new_line() and self.at_member():
                return True
            self.i += 1
        return False

    def skip_to_head(self) -> None:
        """Move to the next thing that may stand outside of constructors. Bodies in braces are skipped."""
        depth = 0
        first = self.i
        while (kind := self.kinds[self.i]) != "end":
            word = self.texts[self.i] if kind == "keyword" else ""
            here = self.i > first and (word == "public" or (depth == 0 and self.on_new_line()))
            if here and (word == "link" or self.at_head()):
                return
            self.i += 1
            if (kind == "}" and depth <= 1) or (kind == ";" and self.i == first + 1):
                return
            depth += (kind == "{") - (kind == "}")
