# SPDX-License-Identifier: BSD-3-Clause
"""Texts as C and C++."""

from __future__ import annotations

from typing import TypeVar

from .code import Code, one_line

Self = TypeVar("Self", bound="Cpp")


class Cpp(Code):
    """C++ code. The code made here is also C."""

    __slots__ = ()

    @classmethod
    def text(cls: type[Self], text: str) -> Self:
        r"""Return a string literal of ASCII, whose bytes are the text's UTF-8.

        Each octal escape has three digits. So a digit after it does not belong to it. A question mark is
        escaped if two of them would begin a trigraph.

        >>> print(Cpp.text('a "b"\n'), Cpp.text("µ1"), Cpp.text("??/"))
        "a \"b\"\012" "\302\2651" "?\?/"
        """
        octets = text.encode("utf-8", "surrogateescape")
        inside = "".join(_escaped(octet) for octet in octets)
        return cls('"{}"'.format(inside.replace("??", "?\\?")))

    @classmethod
    def remark(cls: type[Self], text: str) -> Self:
        """Return a text for a comment.

        No backslash or trigraph in it makes the comment longer, and nothing ends it.
        """
        plain = one_line(text).replace("\\", "/").replace("??", "? ?")
        return cls(plain.replace("*/", "* /").replace("/*", "/ *"))


def _escaped(octet: int) -> str:
    if octet in b'"\\':
        return f"\\{chr(octet)}"
    return chr(octet) if 32 <= octet < 127 else f"\\{octet:03o}"
