# SPDX-License-Identifier: BSD-3-Clause
"""Texts as Rust."""

from __future__ import annotations

from typing import TypeVar

from .code import Code

Self = TypeVar("Self", bound="Rust")


class Rust(Code):
    """Rust code. A remark of it stands in a comment that ends with its line."""

    __slots__ = ()

    @classmethod
    def text(cls: type[Self], text: str) -> Self:
        r"""Return a string literal of ASCII.

        Bytes that were no UTF-8 become U+FFFD, because a string of Rust has none.

        >>> print(Rust.text('a "b" {}\n'), Rust.text("µ1"), Rust.text("\udc80"))
        "a \"b\" {}\u{a}" "\u{b5}1" "\u{fffd}"
        """
        return cls('"{}"'.format("".join(map(_escaped, text))))


def _escaped(character: str) -> str:
    if character in '"\\':
        return f"\\{character}"
    code = ord(character)
    if 32 <= code < 127:
        return character
    return f"\\u{{{0xFFFD if 0xD800 <= code < 0xE000 else code:x}}}"
