# SPDX-License-Identifier: BSD-3-Clause
"""Quoting and wrapping as a formatter would leave it, at 88 columns."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

WIDTH = 88


def quoted(text: str) -> str:
    r"""Return a Python string literal, in double quotes unless single ones save escapes.

    >>> print(quoted("joint 1"), quoted('say "x"'), quoted("a\\b\n"))
    "joint 1" 'say "x"' "a\\b\n"
    """
    quote = "'" if text.count('"') > text.count("'") else '"'
    if not text.isprintable() or "\\" in text or quote in text:
        text = "".join(_escaped(character, quote) for character in text)
    return f"{quote}{text}{quote}"


def _escaped(character: str, quote: str) -> str:
    if character in ("\\", quote):
        return "\\" + character
    if character.isprintable():
        return character
    return character.encode("unicode_escape").decode("ascii")


def docstring(indent: int, *paragraphs: str) -> str:
    """Return a docstring, its first line without indent: one line where it fits, else wrapped.

    >>> print(docstring(4, "A lamp."))
    \"\"\"A lamp.\"\"\"
    """
    clean = [text for paragraph in paragraphs if (text := _clean(paragraph))]
    if len(clean) == 1 and indent + len(clean[0]) + 6 <= WIDTH:
        return f'"""{clean[0]}"""'
    lines: list[str] = []
    for number, paragraph in enumerate(clean):
        if number:
            lines.append("")
        if paragraph.startswith(">>>"):
            lines.append(paragraph)
            continue
        # A line of its own for the quotes is for more than one line of text: a formatter would take it away.
        only = len(clean) == 1 and indent + len(paragraph) + 3 <= WIDTH
        room = WIDTH - indent - (3 if only else 0)
        lines += textwrap.wrap(
            paragraph,
            room,
            initial_indent="" if number else '"""',
            break_long_words=False,
            break_on_hyphens=False,
        )
    if len(lines) == 1:  # one long word
        return f'{lines[0]}"""'
    return "\n".join(
        (" " * indent + line if line and number else line) for number, line in enumerate(lines)
    ) + ("\n" + " " * indent + '"""')


def _clean(text: str) -> str:
    """Keep text from ending the docstring or being read as an escape."""
    if not text.isprintable():
        text = "".join(c if c.isprintable() else " " for c in text)
    return " ".join(text.replace("\\", "\\\\").replace('"""', "'''").split())


@dataclass(frozen=True)
class Call:
    """`keyword=head(arguments)`; without a head a tuple."""

    head: str
    arguments: Sequence[str | Call]
    keyword: str = ""

    def flat(self) -> str:
        inner = ", ".join(a if isinstance(a, str) else a.flat() for a in self.arguments)
        alone = "," if not self.head and len(self.arguments) == 1 else ""
        return f"{self.keyword}{self.head}({inner}{alone})"


def repeated(indent: int, head: str, each: Call, count: int) -> str:
    """Return `head(each for i in range(count))`, on as few lines as it fits.

    >>> print(repeated(8, "self.leg = tuple", Call("Leg", ["self", 'f"leg[{i}]"']), 2))
    self.leg = tuple(Leg(self, f"leg[{i}]") for i in range(2))
    """
    tail = f"for i in range({count})"
    inside = f"{each.flat()} {tail}"
    if indent + len(head) + len(inside) + 2 <= WIDTH:
        return f"{head}({inside})"
    room = " " * (indent + 4)
    if len(room) + len(inside) > WIDTH:
        inside = f"{call(indent + 4, each.head, each.arguments)}\n{room}{tail}"
    return f"{head}(\n{room}{inside}\n{' ' * indent})"


def call(indent: int, head: str, arguments: Sequence[str | Call], tail: str = "") -> str:
    """Return `head(arguments)` and `tail` on one line where it fits, else one argument a line.

    >>> print(call(8, "self.led = self._write", ['"led"']))
    self.led = self._write("led")
    """
    return _laid_out(indent, Call(head, arguments), tail).lstrip()


def _laid_out(indent: int, item: str | Call, tail: str) -> str:
    space = " " * indent
    line = f"{space}{item if isinstance(item, str) else item.flat()}{tail}"
    if isinstance(item, str) or len(line) <= WIDTH:
        return line
    inner = "".join(_laid_out(indent + 4, argument, ",") + "\n" for argument in item.arguments)
    return f"{space}{item.keyword}{item.head}(\n{inner}{space}){tail}"
