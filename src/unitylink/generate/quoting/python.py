# SPDX-License-Identifier: BSD-3-Clause
"""Texts as Python."""

from __future__ import annotations

import re
from typing import TypeVar

from .code import Code, one_line

Self = TypeVar("Self", bound="Python")


class Python(Code):
    """Python code."""

    __slots__ = ()

    @classmethod
    def text(cls: type[Self], text: str) -> Self:
        r"""Return a string literal. It has double quotes unless single ones need fewer escapes.

        >>> print(Python.text("joint 1"), Python.text('say "x"'), Python.text("a\\b\n"))
        "joint 1" 'say "x"' "a\\b\n"
        """
        quote = "'" if text.count('"') > text.count("'") else '"'
        if not text.isprintable() or "\\" in text or quote in text:
            text = "".join(_escaped(character, quote) for character in text)
        return cls(f"{quote}{text}{quote}")

    @classmethod
    def remark(cls: type[Self], text: str) -> Self:
        """Return a text for a comment. A comment in the first two lines of a file could choose its encoding.

        >>> print(Python.remark("coding:utf-7"))
        coding :utf-7
        """
        return cls(re.sub("coding(?=[:=])", "coding ", one_line(text)))

    @classmethod
    def blanks(cls: type[Self], number: int) -> Self:
        """Return the blanks of an indent."""
        return cls(" " * number)

    @classmethod
    def said(cls: type[Self], text: str) -> Self:
        r"""Return a text for the inside of a docstring between three double quotes, on one line.

        It may stand directly before the closing quotes.

        >>> print(Python.said('the arm is "parked"'))
        the arm is "parked\"
        """
        plain = one_line(text).replace("\\", "\\\\").replace('"""', "'''")
        return cls(f'{plain[:-1]}\\"' if plain.endswith('"') else plain)


def _escaped(character: str, quote: str) -> str:
    if character in ("\\", quote):
        return "\\" + character
    if character.isprintable():
        return character
    return character.encode("unicode_escape").decode("ascii")
