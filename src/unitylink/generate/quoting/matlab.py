# SPDX-License-Identifier: BSD-3-Clause
"""Texts as MATLAB, which is also Octave."""

from __future__ import annotations

import re
from typing import TypeVar

from .code import Code, one_line

Self = TypeVar("Self", bound="Matlab")


class Matlab(Code):
    """MATLAB code. A remark of it stands in a comment that ends with its line."""

    __slots__ = ()

    @classmethod
    def text(cls: type[Self], text: str) -> Self:
        r"""Return an expression that is this text, in ASCII.

        Characters beyond that are given as the bytes of UTF-8: a text of Octave has bytes, one of MATLAB has
        UTF-16, and this function makes either.

        >>> print(Matlab.text("the 'arm'"), Matlab.text("µ"), Matlab.text(""))
        'the ''arm''' native2unicode(uint8([194 181]), 'UTF-8') ''
        """
        if text.isascii() and (text.isprintable() or not text):
            return cls("'{}'".format(text.replace("'", "''")))
        octets = " ".join(str(octet) for octet in text.encode("utf-8", "surrogateescape"))
        return cls(f"native2unicode(uint8([{octets}]), 'UTF-8')")

    @classmethod
    def remark(cls: type[Self], text: str) -> Self:
        """Return a text for a comment.

        `help` shows comments. No link in one is shown as a link, because it may run code, and none is read
        as Texinfo.

        >>> print(Matlab.remark('<a href="matlab:x">'), Matlab.remark("-*- texinfo -*-"))
        < a href="matlab:x"> - * - texinfo - * -
        """
        return cls(re.sub(r"<(?=\S)", "< ", one_line(text)).replace("-*-", "- * -"))
