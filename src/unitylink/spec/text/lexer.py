# SPDX-License-Identifier: BSD-3-Clause
"""From text to tokens and comments, with one master pattern.

Every wrong character is reported once and left out.
"""

from __future__ import annotations

import re
import zlib
from dataclasses import dataclass, field

from ..report.diagnostics import Advice, Reporter
from ..source import Source
from ..units import UNITS, UNITS_FOLDED

KEYWORDS = frozenset(
    (
        "link",
        "public",
        "TOSNET",
        "CTRL",
        "BASE",
        "COMM",
        "READ",
        "WRITE",
        "ID",
        "CRC",
        "PUBLISH",
        "ALL",
        "signed",
    )
)
MAX_TOKENS = 360_000  # comments count too; enough for more than 10,000 statements with every property
_LOOKAHEAD = 5
MAX_NAME = 100  # characters of a name; paths consist of names, so this limits every path

_MASTER = re.compile(
    r"""
      (?P<space>[ \t\r\n\f\v]+)
    | (?P<name>\^?[A-Za-z_][A-Za-z_0-9]*)
    | (?P<mark>[@(){},;:=+\[\]]|\.\.?)
    | (?P<number>0[xX][0-9A-Fa-f]+(?![A-Za-z_0-9])|0[bB][01]+(?![A-Za-z_0-9])
        |[0-9]+(?:\.[0-9]+)?(?:[eE][+-]?[0-9]+)?(?![A-Za-z_0-9]))
    | (?P<string>"[^"\\\r\n]*(?:\\[^\r\n][^"\\\r\n]*)*"|'[^'\\\r\n]*(?:\\[^\r\n][^'\\\r\n]*)*')
    | (?P<comment>//[^\r\n]*|/\*[\s\S]*?\*/)
    | (?P<bad_comment>/\*[\s\S]*)
    | (?P<bad_string>["'][^\r\n]*)
    | (?P<bad_number>[0-9][A-Za-z_0-9]*)
    | (?P<foreign>\*/|--[^\r\n]*)
    | (?P<operator>[-*/%&|]|<<|>>)
    | (?P<bad>[“„‘][^"'\r\n]{0,250}?[“”’]|\#[^\r\n]*
        |[^ \t\r\n\f\vA-Za-z_0-9@(){},;:=.+\[\]"'/^*\#%&|<>-]+|[\^<>])
    """,
    re.VERBOSE,
)

_ESCAPE = re.compile(r"\\(u[0-9A-Fa-f]{4}|.?)", re.DOTALL)
_LINE_END = re.compile(r"[\r\n]")
_ESCAPES = {"b": "\b", "t": "\t", "n": "\n", "f": "\f", "r": "\r", '"': '"', "'": "'", "\\": "\\"}


@dataclass
class Tokens:
    """The tokens of a text as parallel lists.

    The last ones have the kind "end", so that the parser can look ahead.

    A kind is "name", "keyword", "number", "string", "end", or the mark or operator itself. `texts` has a name
    without its `^`, and everything else as written.
    """

    kinds: list[str] = field(default_factory=list)
    texts: list[str] = field(default_factory=list)
    starts: list[int] = field(default_factory=list)
    ends: list[int] = field(default_factory=list)
    comments: list[tuple[int, int]] = field(default_factory=list)  # (start, end) of each
    # `///` lines, by the token before which they stand
    documentation: dict[int, str] = field(default_factory=dict)
    # `///` comments, by the token after which they stand in the same line
    trailing: dict[int, str] = field(default_factory=dict)
    faults: list[int] = field(default_factory=list)  # where a wrong character was reported
    truncated: bool = False  # text is missing, because a comment or the token limit took the rest


class _Said:
    """The `///` comments of a text. Many lines may belong to one token. Each line is looked at once."""

    def __init__(self, text: str, tokens: Tokens) -> None:
        self.text = text
        self.tokens = tokens
        self.lines: dict[tuple[bool, int], list[str]] = {}
        self.line = (-1, -1)  # (end of a token, the line in which it stands)

    def take(self, word: str, start: int, token_end: int) -> None:
        """Note a comment. `token_end` is the end of the token before it, or -1 if there is none."""
        if token_end != self.line[0]:
            end = _LINE_END.search(self.text, token_end)
            self.line = token_end, end.start() if end is not None else len(self.text)
        behind = token_end >= 0 and start <= self.line[1]
        key = behind, len(self.tokens.kinds) - behind
        self.lines.setdefault(key, []).append(word[3:].strip())

    def end(self) -> None:
        for (behind, token), lines in self.lines.items():
            table = self.tokens.trailing if behind else self.tokens.documentation
            table[token] = "\n".join(lines)


def tokenize(reporter: Reporter, source: Source | None = None) -> Tokens:
    """Return the tokens of `source`. By default this is the reporter's first. Report wrong characters."""
    source = source or reporter.sources.first
    text, base = source.text, source.base
    tokens = Tokens()
    kinds, texts, starts, ends = tokens.kinds, tokens.texts, tokens.starts, tokens.ends
    position = 1 if text.startswith("\ufeff") else 0  # a byte order mark
    said = _Said(text, tokens)
    open_bracket = -1  # where a bracket that UL-spec does not have was reported
    for match in _MASTER.finditer(text, position):
        kind = match.lastgroup
        if kind == "space":
            continue
        word = match.group()
        start = match.start() + base
        end = start + len(word)
        if kind in ("mark", "operator"):
            kind = word
        elif kind == "name":
            if word in KEYWORDS:
                kind = "keyword"
            elif word[0] == "^":
                word = word[1:]
            if len(word) > MAX_NAME:
                word = _shorten(reporter, word, start, end)
        elif kind == "comment":
            tokens.comments.append((start, end))
            if word.startswith("///") and word[3:4] != "/":
                said.take(word, start - base, ends[-1] - base if ends else -1)
            if len(kinds) + len(tokens.comments) < MAX_TOKENS:
                continue
            _report_too_many(reporter, tokens, start, end)
            break
        elif kind == "string":
            if "\\" in word:
                _check_escapes(reporter, tokens, word, start)
        elif kind != "number":
            assert kind is not None  # every alternative of the pattern has a name
            if kind in ("bad", "foreign"):
                tokens.faults.append(start)
                if word[0] != ">" or not _closes(reporter, open_bracket, start):
                    _report_bad(reporter, word, start, end)
                open_bracket = start if word[0] == "<" else -1 if word[0] == ">" else open_bracket
                if reporter.full:
                    tokens.truncated = True
                    break
                continue
            tokens.faults.append(start)
            kind = _report_malformed(reporter, kind, word, start, end)
            if not kind:
                tokens.truncated = True
                break
        kinds.append(kind)
        texts.append(word)
        starts.append(start)
        ends.append(end)
        if len(kinds) + len(tokens.comments) >= MAX_TOKENS:
            _report_too_many(reporter, tokens, start, end)
            break
    said.end()
    kinds.extend(["end"] * _LOOKAHEAD)
    texts.extend([""] * _LOOKAHEAD)
    starts.extend([base + len(text)] * _LOOKAHEAD)
    ends.extend([base + len(text)] * _LOOKAHEAD)
    return tokens


def _report_too_many(reporter: Reporter, tokens: Tokens, start: int, end: int) -> None:
    message = f"more than {MAX_TOKENS:,} words, marks and comments"
    reporter.report("UL003", start, end, message, "divide the spec into several")
    tokens.truncated = True


def _closes(reporter: Reporter, open_bracket: int, start: int) -> bool:
    """Is this the second half of a wrong pair of brackets in one line? Then it is not reported again."""
    line_of = reporter.sources.line_of
    return open_bracket >= 0 and line_of(open_bracket) == line_of(start)


def unescape(text: str) -> str:
    r"""Return the value of a string token, without quotes and escapes.

    >>> unescape('"a\\tb"')
    'a\tb'
    """
    inner = text[1:-1]
    return _ESCAPE.sub(_unescape_one, inner) if "\\" in inner else inner


def _unescape_one(match: re.Match[str]) -> str:
    letters = match.group(1)
    if len(letters) == 5:
        return chr(int(letters[1:], 16))
    return _ESCAPES.get(letters, letters)


def _check_escapes(reporter: Reporter, tokens: Tokens, word: str, start: int) -> None:
    for match in _ESCAPE.finditer(word, 1, len(word) - 1):
        letters = match.group(1)
        surrogate = len(letters) == 5 and 0xD800 <= int(letters[1:], 16) <= 0xDFFF
        if (len(letters) != 5 and letters not in _ESCAPES) or surrogate:
            at = start + match.start()
            if reporter.full:
                return
            tokens.faults.append(start)
            known = r"\b \t \n \f \r \" \' \\ and \uXXXX"
            what = "a half of a surrogate pair" if surrogate else "an unknown escape"
            reporter.report(
                "UL007",
                at,
                at + len(match.group()),
                f"{_show(match.group())} is {what}",
                f"there are {known}",
            )


def _shorten(reporter: Reporter, word: str, start: int, end: int) -> str:
    message = f"a name of {len(word):,} characters is too long"
    reporter.report("UL009", start, end, message, f"names have at most {MAX_NAME} characters")
    return f"{word[:20]}~{zlib.crc32(word.encode()):08x}"  # still one name for each text


def _report_bad(reporter: Reporter, word: str, start: int, end: int) -> None:
    hint = ""
    if word[0] in "#/" or word[:2] == "--":
        hint = "comments are `// …` and `/* … */`"
        word = word[: 1 if word[0] == "#" else 2]
        end = start + len(word)
    elif word == "*/":
        hint = "no comment is open here: comments do not nest"
    elif word == "^":
        hint = (
            "`^` stands directly before a name that would otherwise be a keyword; a unit stands in quotes: "
            '"m/s^2"'
        )
    elif word[0] in "“„‘”’":
        hint = "strings stand in straight quotes, \"…\" or '…'"
    elif any(ord(c) > 127 for c in word):
        hint = "names are made of A-Z a-z 0-9 _; other characters may stand in strings and comments"
    elif word[0] in "<>":
        hint = "brackets are `(…)`, `{…}` and `[…]`; numbers are shifted by `<<` and `>>`"
    shown = _show(word if len(word) <= 12 else word[:12] + "…")
    reporter.report("UL004", start, end, f"unexpected {shown}", hint)


def _report_malformed(reporter: Reporter, kind: str, word: str, start: int, end: int) -> str:
    """Report a malformed token.

    Return the kind of token for which it stands, or "" if it took all text to the end.
    """
    if kind == "bad_comment":
        reporter.report("UL005", start, start + 2, "this comment never ends", "close it with `*/`")
        return ""
    if kind == "bad_string":
        message = "this string does not end on its line"
        reporter.report("UL006", start, end, message, f"close it with {word[0]}")
        return "string"
    hint: str | Advice = "numbers are 10, 0x1F, 0b101, 0.5 and 1e-3"
    unit = word.lstrip("0123456789")
    number, unit = (
        word[: len(word) - len(unit)],
        unit if unit in UNITS else UNITS_FOLDED.get(unit.lower(), ""),
    )
    if unit and number:
        hint = Advice(
            f"a space stands between a number and its unit: `{number} {unit}`",
            ((start, end, f"{number} {unit}"),),
        )
    reporter.report("UL008", start, end, f"{_show(word[:24])} is not a number", hint)
    return "number"


def _show(text: str) -> str:
    """Return `text` in back quotes, with unprintable characters escaped."""
    return "`" + "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in text) + "`"
