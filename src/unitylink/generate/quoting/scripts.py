# SPDX-License-Identifier: BSD-3-Clause
"""Texts in CMake, Markdown, ROS messages, Shell, Tcl and YAML."""

from __future__ import annotations

import json
import re
from typing import TypeVar

from .code import Code, UnquotedText, one_line

Y = TypeVar("Y", bound="Yaml")
M = TypeVar("M", bound="Message")
D = TypeVar("D", bound="Markdown")
T = TypeVar("T", bound="Tcl")

_PLAIN_YAML = re.compile(r"[A-Za-z_][A-Za-z0-9_]*", re.ASCII)
_YAML_WORDS = frozenset({"y", "n", "yes", "no", "on", "off", "true", "false", "null"})


class CMake(Code):
    """CMake. It has no literals with texts of a spec."""

    __slots__ = ()


class Shell(Code):
    """A script of the shell. It has no literals with texts of a spec."""

    __slots__ = ()


class Yaml(Code):
    """YAML."""

    __slots__ = ()

    @classmethod
    def text(cls: type[Y], text: str) -> Y:
        r"""Return a string.

        It is bare if it is certainly read as a string, else in double quotes, as in JSON.

        >>> print(Yaml.text("joint_1"), Yaml.text("no"), Yaml.text("a: b\n- c"))
        joint_1 "no" "a: b\n- c"
        """
        bare = _PLAIN_YAML.fullmatch(text) and text.lower() not in _YAML_WORDS
        return cls(text if bare else json.dumps(text))


class Message(Code):
    """A message or service of ROS. Its comments are copied into headers of C and C++, between /* and */."""

    __slots__ = ()

    @classmethod
    def remark(cls: type[M], text: str) -> M:
        """Return a text for a comment.

        The comment ends with its line, and the text cannot end a comment of C.

        >>> print(Message.remark("speed */ of"))
        speed * / of
        """
        plain = one_line(text).replace("\\", "/").replace("??", "? ?")
        return cls(plain.replace("*/", "* /").replace("/*", "/ *"))


class Markdown(Code):
    """Markdown. From a spec it has only names, and the name of a file between back quotes."""

    __slots__ = ()

    @classmethod
    def remark(cls: type[D], text: str) -> D:
        """Return a text for the middle of a comment of HTML."""
        return cls(re.sub("-(?=-)", "- ", one_line(text)))


class Tcl(Code):
    """A script for the tools of vendors."""

    __slots__ = ()

    @classmethod
    def text(cls: type[T], text: str) -> T:
        r"""Return one word.

        It is in braces, where no sign has a meaning, or has a backslash before each sign.

        >>> print(Tcl.text("/home/me/[exit] $x/arm.vhd"), Tcl.text("/a{b c"))
        {/home/me/[exit] $x/arm.vhd} /a\{b\ c

        Raises UnquotedText for a text with ends of lines. No name of a file or of a pin has them.
        """
        if not text.isprintable():
            raise UnquotedText(f"{text!r} is no word of Tcl")
        if not set(text) & set("{}\\"):
            return cls(f"{{{text}}}")
        return cls(re.sub(r"([^A-Za-z0-9_./,=:+-])", r"\\\1", text, flags=re.ASCII))


class Toml(Code):
    """A manifest of Cargo. Only names come into it."""

    __slots__ = ()
