# SPDX-License-Identifier: BSD-3-Clause
"""The structure of a generated file: everything that acts in it.

A mark replaces each text, and remarks are left out.

Two files have the same structure if they differ only in their texts. The readers here are no part of
Unity-Link. They are Python's own, those of its library, and lexers of C++, VHDL and others that follow their
standards.
"""

from __future__ import annotations

import ast
import io
import json
import re
import tokenize
from collections.abc import Callable, Hashable, Iterator
from functools import lru_cache
from html.parser import HTMLParser
from pathlib import PurePosixPath
from xml.etree import ElementTree

from ruamel.yaml import YAML
from ruamel.yaml.tokens import ScalarToken

TEXT, REMARK = "a text", "a remark"
_HIDING = "\0\u2028\u2029\u202e\u2066\u0085\x0b\x0c\x1b\r"
_XACRO = re.compile(r"\$\$+[{(]|(\$[{(][^)}]*[)}])")


class Broken(Exception):
    """A file is not valid in its own language."""


def structure(name: str, text: str) -> Hashable:
    """Return the structure of a file, or raise Broken. The ending of `name` tells the language."""
    suffix = PurePosixPath(name).suffix
    if suffix not in _READERS:
        raise Broken(f"{name}: nothing here reads {suffix!r}; add a reader of it to _READERS")
    # The strings of JSON may hold anything.
    if suffix not in (".json", ".html") and any(c in text for c in _HIDING):
        raise Broken(f"{name} has characters that hide or end lines")
    return _read(suffix, text)


@lru_cache(maxsize=8)  # the Python of a robot is in three packages
def _read(suffix: str, text: str) -> Hashable:
    return _READERS[suffix](text)


def _python(text: str) -> Hashable:
    try:
        # Decode the file as Python does: its first lines may name an encoding.
        encoding, _ = tokenize.detect_encoding(io.BytesIO(text.encode()).readline)
        tree = ast.parse(text.encode())
    except (SyntaxError, ValueError) as error:
        raise Broken(f"Python: {error}") from error
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, (str, bytes)):
            node.value = TEXT
        if isinstance(node, (ast.Module, ast.ClassDef, ast.FunctionDef)):
            node.body = [one for one in node.body if not _says_only(one)]
    return encoding, ast.dump(tree)


def _says_only(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


_CPP = re.compile(
    r"""(?P<remark>//[^\n]*|/\*.*?\*/)|(?P<text>(?:u8|[uUL])?R?"(?:[^"\\\n]|\\.)*"|'(?:[^'\\\n]|\\.)*')
    |(?P<token>[A-Za-z_]\w*|\.?[0-9](?:'?[\w.]|(?<=[eEpP])[+-])*|\s+|[^\s"'])""",
    re.VERBOSE | re.DOTALL | re.ASCII,
)
_TRIGRAPHS = dict(zip("=/'()!<>-", "#\\^[]|{}~", strict=True))


def _cpp(text: str) -> Hashable:
    """Read it with trigraphs, which C++ before 2017 replaces first, and without.

    A backslash joins two lines.
    """
    if "??" not in text:
        return tuple(_lexed(text.replace("\\\n", ""), _CPP))
    without = re.sub(r"\?\?([=/'()!<>-])", lambda m: _TRIGRAPHS[m[1]], text)
    readings = {tuple(_lexed(one.replace("\\\n", ""), _CPP)) for one in (text, without)}
    if len(readings) > 1:
        raise Broken("C++: trigraphs change what the file is")
    return readings.pop()


_RUST = re.compile(
    r"""(?P<remark>//[^\n]*|/\*.*?\*/)|(?P<text>"(?:[^"\\]|\\.)*")
    |(?P<token>'(?:[^'\\\n]|\\[^\n]+?)'|'?[A-Za-z_]\w*|[0-9][\w.]*|\s+|[^\s"'])""",
    re.VERBOSE | re.DOTALL | re.ASCII,
)
_MATLAB = re.compile(
    r"""(?P<remark>%[^\n]*)|(?P<text>'(?:[^'\n]|'')*'|native2unicode\(uint8\(\[[0-9 ]*\]\),[ ]'UTF-8'\))
    |(?P<token>\.\.\.[ ]*\n|[A-Za-z]\w*|[0-9][\w.]*|\s+|[^\s"'%\#])""",
    re.VERBOSE | re.DOTALL | re.ASCII,
)


def _matlab(text: str) -> Hashable:
    """Some comments act: they begin others of many lines or tests, or `help` shows links and Texinfo."""
    for match in _MATLAB.finditer(text):
        if match["remark"] and re.search(r"^%[{}!#]|<\S|-\*-", match["remark"]):
            raise Broken("MATLAB: a comment that acts")
    return tuple(_lexed(text, _MATLAB))


_VHDL = re.compile(
    r"""(?P<remark>--[^\n]*|/\*.*?\*/)|(?P<text>"(?:[^"\n]|"")*")
    |(?P<token>\\(?:[^\\\n]|\\\\)*\\|'.'|[A-Za-z]\w*|[0-9]\w*|\s+|[^\s"])""",
    re.VERBOSE | re.DOTALL | re.ASCII,
)
_VHDL_COMMANDS = re.compile(r"--\s*(?:synthesis|pragma|synopsys|rtl_synthesis|psl)\b", re.IGNORECASE)


def _vhdl(text: str) -> Hashable:
    for match in _VHDL.finditer(text):
        if match["remark"] and _VHDL_COMMANDS.match(match["remark"]):
            raise Broken("VHDL: a comment that tools obey")
    return tuple(_lexed(text, _VHDL, texts=False))


_CMAKE = re.compile(
    r"""(?P<remark>\#\[(?P<equals>=*)\[.*?\](?P=equals)\]|\#[^\n]*)|(?P<text>"(?:[^"\\]|\\.)*")
    |(?P<token>\[(?P<bracket>=*)\[.*?\](?P=bracket)\]|\s+|[^\s"\#])""",
    re.VERBOSE | re.DOTALL,
)
_SHELL = re.compile(
    r"""(?P<remark>(?<![^\s;])\#[^\n]*)|(?P<text>"(?:[^"\\]|\\.)*"|'[^']*')|(?P<token>\\.|\s+|[^\s"'])""",
    re.VERBOSE | re.DOTALL,
)
_TCL = re.compile(
    r"""(?P<remark>^\#(?:[^\n\\]|\\.)*)|(?P<text>\{(?:[^{}\\]|\\.)*\})|(?P<token>\\.|\s+|.)""",
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
_LINES = re.compile(r"(?P<remark>\#[^\n]*)|(?P<text>\Z.)|(?P<token>[^\#\n]+|\n)")


def _lexed(text: str, pattern: re.Pattern[str], *, texts: bool = True) -> Iterator[str]:
    """Yield tokens without remarks. Also yield an end of line if the next token is in another line."""
    position, ended = 0, True
    while position < len(text):
        match = pattern.match(text, position)
        if match is None:
            raise Broken(f"no token begins at {text[position : position + 40]!r}")
        position = match.end()
        if match["text"] is not None:
            yield TEXT if texts else match["text"]
        elif match["remark"] is None and match["token"].strip():
            yield match["token"]
        elif match["remark"] is None and "\n" in match["token"] and not ended:
            yield "\n"
            ended = True
            continue
        else:
            continue
        ended = False


def _xml(text: str) -> Hashable:
    try:
        builder = ElementTree.TreeBuilder(insert_comments=True, insert_pis=True)
        root = ElementTree.fromstring(text, ElementTree.XMLParser(target=builder))
    except ElementTree.ParseError as error:
        raise Broken(f"XML: {error}") from error
    return tuple((str(item.tag), tuple(item.attrib), len(item)) for item in root.iter())


def _xacro(text: str) -> Hashable:
    """The structure of XML in which ROS also evaluates texts such as $(find y)."""
    evaluated = [m[1] for m in _XACRO.finditer(re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)) if m[1]]
    return _xml(text), tuple(evaluated)


def _yaml(text: str) -> Hashable:
    try:
        loaded = YAML(typ="safe", pure=True).load(text)
        tokens = list(YAML(typ="safe", pure=True).scan(text))
    except Exception as error:
        raise Broken(f"YAML: {error}") from error
    names = tuple(type(t).__name__ if isinstance(t, ScalarToken) else str(t) for t in tokens)
    return names, _shape(loaded)


def _json(text: str) -> Hashable:
    return _shape(json.loads(text))


def _shape(value: object) -> Hashable:
    if isinstance(value, dict):
        return tuple((key, _shape(inner)) for key, inner in value.items())
    if isinstance(value, list):
        return tuple(map(_shape, value))
    return TEXT if isinstance(value, str) else (type(value).__name__, value)


def _html(text: str) -> Hashable:
    found: list[Hashable] = []
    model: list[str] = []

    class Reader(HTMLParser):
        within = ""

        def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
            self.within = "model" if ("id", "model") in attrs else tag
            found.append((tag, tuple(attrs)))

        def handle_endtag(self, tag: str) -> None:
            self.within = ""
            found.append(f"/{tag}")

        def handle_data(self, data: str) -> None:
            (model if self.within == "model" else found).append(data)

        def handle_comment(self, data: str) -> None:
            found.append(REMARK)

        def handle_decl(self, decl: str) -> None:
            found.append(decl)

        def unknown_decl(self, data: str) -> None:
            found.append(f"![{data}")

        def handle_pi(self, data: str) -> None:
            found.append(f"?{data}")

    Reader().feed(text)
    # A script ends at `</script`. A comment within it makes browsers look for another end.
    if re.search(r"</?script|<!--", "".join(model), re.IGNORECASE):
        raise Broken("HTML: the model could end its script")
    return tuple(found), _shape(json.loads("".join(model)))


_MARKDOWN = re.compile(
    r"\\[!-/:-@\[-`{-~]|(?P<remark><!--.*?-->)|(?P<code>(?<!`)`[^`\n]+`(?!`))|(?P<sign>[`*<>\[\]|#~_$\n])",
    re.DOTALL,
)


def _markdown(text: str) -> Hashable:
    found = _MARKDOWN.finditer(text)
    return tuple(m["sign"] or (m["code"] and TEXT) or REMARK for m in found if m.lastgroup)


def _message(text: str) -> Hashable:
    """rosidl puts remarks into headers of C, between /* and */."""
    if "*/" in text or re.search(r"\\$|\?\?/", text, re.MULTILINE):
        raise Broken("a remark of a message ends a comment of C")
    return tuple(token.strip() for token in _lexed(text, _LINES))


def _of(pattern: re.Pattern[str]) -> Callable[[str], Hashable]:
    return lambda text: tuple(_lexed(text, pattern))


_READERS: dict[str, Callable[[str], Hashable]] = {
    ".c": _cpp,
    ".cpp": _cpp,
    ".h": _cpp,
    ".hpp": _cpp,
    ".html": _html,
    ".json": _json,
    ".launch": _xacro,
    ".m": _matlab,
    ".md": _markdown,
    ".msg": _message,
    ".py": _python,
    ".rs": _of(_RUST),
    ".sdc": _of(_TCL),
    ".sh": _of(_SHELL),
    ".srv": _message,
    ".tcl": _of(_TCL),
    ".toml": _of(_LINES),
    ".txt": _of(_CMAKE),
    ".vhd": _vhdl,
    ".xacro": _xacro,
    ".xdc": _of(_TCL),
    ".xml": _xml,
    ".yaml": _yaml,
}
