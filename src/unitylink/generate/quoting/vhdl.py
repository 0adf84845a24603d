# SPDX-License-Identifier: BSD-3-Clause
"""Texts as VHDL."""

from __future__ import annotations

from typing import TypeVar

from .code import Code, one_line

Self = TypeVar("Self", bound="Vhdl")

_LONGEST = 200  # characters of a remark


class Vhdl(Code):
    """VHDL code. No text of a spec is a literal in it."""

    __slots__ = ()

    @classmethod
    def remark(cls: type[Self], text: str) -> Self:
        """Return text for the middle of a comment: one line of ASCII, at most 200 characters.

        Tools obey comments that begin with a word of theirs (`synthesis translate_off`): begin none with it.
        """
        ascii_line = one_line(text).encode("ascii", "backslashreplace").decode()
        return cls(" ".join(ascii_line.split())[:_LONGEST])

    def with_remark(self: Self, text: str) -> Self:
        """Return this line with a text as its comment, or only the line without a text."""
        return self.of("{} -- {}", self, self.remark(text)) if text else self
