# SPDX-License-Identifier: BSD-3-Clause
"""Docstrings and calls, wrapped at 88 columns as a formatter would do it."""

from __future__ import annotations

import textwrap
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Union

from ..quoting import Python

WIDTH = 88


def docstring(indent: int, *paragraphs: str) -> Python:
    """Return a docstring, with no indent in its first line. It is one line if it fits, else wrapped.

    >>> print(docstring(4, "A lamp."))
    \"\"\"A lamp.\"\"\"
    """
    clean = [text for paragraph in paragraphs if (text := Python.said(paragraph))]
    if len(clean) == 1 and indent + len(clean[0]) + 6 <= WIDTH:
        return Python(f'"""{clean[0]}"""')
    lines: list[str] = []
    for number, paragraph in enumerate(clean):
        first = "" if number else '"""'
        if number:
            lines.append("")
        if paragraph.startswith(">>>"):
            lines.append(first + paragraph)
            continue
        # The closing quotes get their own line only after several lines of text. Otherwise a formatter would
        # move them.
        only = len(clean) == 1 and indent + len(paragraph) + 3 <= WIDTH
        room = WIDTH - indent - (3 if only else 0)
        lines += textwrap.wrap(
            paragraph, room, initial_indent=first, break_long_words=False, break_on_hyphens=False
        )
    if len(lines) == 1:  # one long word
        return Python(f'{lines[0]}"""')
    return Python(
        "\n".join((" " * indent + line if line and number else line) for number, line in enumerate(lines))
        + ("\n" + " " * indent + '"""')
    )


@dataclass(frozen=True)
class Call:
    """`keyword=head(arguments)`. Without a head, it is a tuple. Head and keyword are names or Python."""

    head: str
    arguments: Sequence[Argument]
    keyword: str = ""

    def start(self) -> Python:
        """Return the text before the arguments."""
        return Python.of("{}={}(" if self.keyword else "{}{}(", self.keyword, self.head)

    def flat(self) -> Python:
        inner = Python(", ").join(a if isinstance(a, str) else a.flat() for a in self.arguments)
        alone = not self.head and len(self.arguments) == 1
        return Python.of("{}{},)" if alone else "{}{})", self.start(), inner)


Argument = Union[str, Call]


def repeated(indent: int, head: str, each: Call, count: int) -> Python:
    """Return `head(each for i in range(count))`, on as few lines as possible.

    >>> leg = Call("Leg", ["self", Python('f"leg[{i}]"')])
    >>> print(repeated(8, Python("self.leg = tuple"), leg, 2))
    self.leg = tuple(Leg(self, f"leg[{i}]") for i in range(2))
    """
    tail = Python.of("for i in range({})", count)
    inside = Python.of("{} {}", each.flat(), tail)
    if indent + len(head) + len(inside) + 2 <= WIDTH:
        return Python.of("{}({})", head, inside)
    room = Python.blanks(indent + 4)
    if len(room) + len(inside) > WIDTH:
        inside = Python.of("{}\n{}{}", call(indent + 4, each.head, each.arguments), room, tail)
    return Python.of("{}(\n{}{}\n{})", head, room, inside, Python.blanks(indent))


def call(indent: int, head: str, arguments: Sequence[Argument], tail: str = "") -> Python:
    """Return `head(arguments)` and `tail` on one line if it fits, else one argument on each line.

    >>> print(call(8, Python("self.led = self._write"), [Python.text("led")]))
    self.led = self._write("led")
    """
    return _laid_out(indent, Call(head, arguments), tail, first=True)


def _laid_out(indent: int, item: Argument, tail: str, *, first: bool = False) -> Python:
    space = Python.blanks(indent)
    margin = Python("") if first else space
    flat = item if isinstance(item, str) else item.flat()
    if isinstance(item, str) or indent + len(flat) + len(tail) <= WIDTH:
        return Python.of("{}{}{}", margin, flat, tail)
    inner = Python("").join(
        Python.of("{}\n", _laid_out(indent + 4, argument, Python(","))) for argument in item.arguments
    )
    return Python.of("{}{}\n{}{}){}", margin, item.start(), inner, space, tail)
