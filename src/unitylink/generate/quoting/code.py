# SPDX-License-Identifier: BSD-3-Clause
"""Text that is code. It is made of the generators' own code, of names, of numbers, and of quoted texts.

A text of a spec becomes code only through the quoting function of a language. So no unquoted text can get
into a file. An attempt raises UnquotedText.
"""

from __future__ import annotations

import math
import re
from collections.abc import Iterable
from typing import SupportsIndex, TypeVar, Union

# Matches a name, a path in a spec or in ROS, or digits. In a table, blanks may follow. This acts in no
# language.
_NAME = re.compile(r"[A-Za-z0-9_]+(?:\[[0-9]+\])?(?:[./][A-Za-z0-9_]+(?:\[[0-9]+\])?)* *", re.ASCII)
_SHOWN = 60  # the most characters that are shown of a refused text

Self = TypeVar("Self", bound="Code")
Part = Union[str, int, float]


class UnquotedText(TypeError):
    """A generator put a text into code without quoting it. This is found before anything is written."""


class Code(str):
    """Code of one language, in a subclass. `Code` itself belongs to no language.

    `Code("...")` is for text of our own sources. `of` is for everything that is joined.

    >>> from unitylink.generate.quoting import Cpp
    >>> Cpp.of("names.push_back({});", Cpp.text('say "x"'))
    'names.push_back("say \\\\"x\\\\"");'
    >>> Cpp.of("names.push_back({});", 'say "x"')
    Traceback (most recent call last):
    ...
    unitylink.generate.quoting.code.UnquotedText: 'say "x"' is neither quoted for Cpp nor a name
    """

    __slots__ = ()

    @classmethod
    def of(cls: type[Self], pattern: str, *parts: Part, **named: Part) -> Self:
        """Return `pattern`, filled in as by `str.format`. Each part is code, a number or a name."""
        checked = {key: cls.part(value) for key, value in named.items()}
        return cls(pattern.format(*map(cls.part, parts), **checked))

    @classmethod
    def part(cls, value: Part) -> Part:
        """Return `value` if it may become part of code of this language without a change.

        Raises UnquotedText for everything else.
        """
        if isinstance(value, cls):
            return value
        if isinstance(value, (int, float)) and not isinstance(value, bool) and math.isfinite(value):
            return value
        if isinstance(value, str) and not isinstance(value, Code) and (not value or _NAME.fullmatch(value)):
            return value
        shown = value[:_SHOWN] if isinstance(value, str) else value
        raise UnquotedText(
            f"{str.__repr__(shown) if isinstance(shown, str) else repr(shown)} is neither "
            f"quoted for {cls.__name__} nor a name"
        )

    @classmethod
    def text(cls: type[Self], text: str) -> Self:
        """Return a text as a literal of the language."""
        raise UnquotedText(f"{cls.__name__} has no literals of texts")

    @classmethod
    def remark(cls: type[Self], text: str) -> Self:
        """Return a text for the middle of a comment that ends with its line."""
        return cls(one_line(text))

    def join(self: Self, parts: Iterable[Part]) -> Self:
        return type(self)(str.join(self, [str(self.part(part)) for part in parts]))

    def ljust(self: Self, width: SupportsIndex, fill: str = " ") -> Self:
        return type(self)(str.ljust(self, width, fill))


def one_line(text: str) -> str:
    """Return a text on one line. Characters that cannot be printed, such as ends of lines, become blanks.

    >>> one_line("one\\ntwo\\u202e  three")
    'one two three'
    """
    return " ".join("".join(c if c.isprintable() else " " for c in text).split())


def file_name(name: str) -> str:
    """Return a file's name in a form for remarks: letters, digits and a few signs that act in no language.

    Some comments act. Near the beginning of a file, one may choose Python's encoding, or set up an editor.

    >>> file_name("arm-2.ul"), file_name("x coding:utf-7 --> .ul")
    ('arm-2.ul', 'x coding_utf-7 _-_ .ul')
    """
    plain = "".join(c if c.isalnum() or c in "._- " else "_" for c in name)
    return re.sub("-(?=-)", "_", plain)
