# SPDX-License-Identifier: BSD-3-Clause
"""Texts as XML, HTML and xacro."""

from __future__ import annotations

import json
import re
from typing import TypeVar

from .code import Code, one_line

Self = TypeVar("Self", bound="Xml")

_ESCAPES = {"&": "&amp;", "<": "&lt;", ">": "&gt;", '"': "&quot;", "'": "&apos;"}


class Xml(Code):
    """XML."""

    __slots__ = ()

    @classmethod
    def text(cls: type[Self], text: str) -> Self:
        """Return a text for an element or, between quotes, for an attribute, on one line.

        XML has no control characters, not even escaped ones.

        >>> print(Xml.text('a "b" <c>'))
        a &quot;b&quot; &lt;c&gt;
        """
        return cls("".join(_ESCAPES.get(c, c) for c in one_line(text)))

    @classmethod
    def remark(cls: type[Self], text: str) -> Self:
        """Return a text for the middle of a comment. XML allows no two dashes there.

        >>> print(Xml.remark("a --> b"), Xml.remark("---"))
        a - -> b - - -
        """
        return cls(re.sub("-(?=-)", "- ", one_line(text)))


class Html(Xml):
    """A page."""

    __slots__ = ()

    @classmethod
    def data(cls: type[Self], value: object) -> Self:
        r"""Return plain data as the content of a script element. Nothing in it can end the element.

        >>> print(Html.data({"said": "</script>"}))
        {"said":"\u003c/script>"}
        """
        text = json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
        return cls(text.replace("<", "\\u003c"))


class Xacro(Xml):
    """XML for xacro, which evaluates `${..}` as Python and `$(..)` as a command of its own."""

    __slots__ = ()

    @classmethod
    def text(cls: type[Self], text: str) -> Self:
        """Return a text for an attribute that xacro does not change.

        >>> print(Xacro.text("${exit()} $(find x) 5$"))
        $${exit()} $$(find x) 5$
        """
        return cls(re.sub(r"(\$+)(?=[{(])", r"$\1", Xml.text(text)))
