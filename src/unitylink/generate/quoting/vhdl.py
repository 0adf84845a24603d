# SPDX-License-Identifier: BSD-3-Clause
"""Texts as VHDL."""

from __future__ import annotations

from typing import TypeVar

from .code import Code, one_line

Self = TypeVar("Self", bound="Vhdl")

_LONGEST = 200  # the most characters of a remark


class Vhdl(Code):
    """VHDL code. It has no literals with texts of a spec."""

    __slots__ = ()

    @classmethod
    def remark(cls: type[Self], text: str) -> Self:
        """Return text for the middle of a comment: one line of ASCII, at most 200 characters.

        Tools obey comments that begin with a word of theirs (`synthesis translate_off`). So no comment may
        begin with the text.
        """
        ascii_line = one_line(text).encode("ascii", "backslashreplace").decode()
        return cls(" ".join(ascii_line.split())[:_LONGEST])

    def with_remark(self: Self, text: str) -> Self:
        """Return this line with a text as its comment. Without a text, return only the line."""
        return self.of("{} -- {}", self, self.remark(text)) if text else self
