# SPDX-License-Identifier: BSD-3-Clause
"""`{…}` in the strings of an array: `leg[6]: leg("leg {i+1}")`. `{{` and `}}` stand for braces.

This holds only there. In all other strings, a brace is a brace, as before.
"""

from __future__ import annotations

import re

from ..report.diagnostics import Reporter
from ..source import Source
from .cursor import Panic
from .expressions import ExpressionReader
from .lexer import tokenize
from .syntax import Argument, Expression, Text

_PART = re.compile(r"\{\{|\}\}|\{([^{}]*)\}|[{}]")


def interpolate(argument: Argument, reporter: Reporter) -> Argument:
    """Return an argument in which each string has its expressions beside it.

    Raises Panic after a diagnostic.
    """
    parts: list[Expression] = []
    for part in argument.parts:
        if isinstance(part, Text) and ("{" in part.value or "}" in part.value):
            parts += _split(part, reporter)
        else:
            parts.append(part)
    return Argument(parts, argument.start, argument.end, argument.key)


def _split(text: Text, reporter: Reporter) -> list[Expression]:
    parts: list[Expression] = [Text("", text.start, text.end)]  # the sum is a string even if it is only "{i}"
    plain = ""
    last = 0
    # If there is no escape, each place in the value is one character further in the text.
    exact = text.end - text.start == len(text.value) + 2
    for match in _PART.finditer(text.value):
        plain += text.value[last : match.start()]
        last = match.end()
        found = match.group()
        if found in ("{{", "}}"):
            plain += found[0]
            continue
        start = text.start + 1 + match.start() if exact else text.start
        end = start + len(found) if exact else text.end
        if match.group(1) is None or not match.group(1).strip():
            message = (
                "this brace has no other half"
                if match.group(1) is None
                else "there is nothing in these braces"
            )
            hint = f"in an array's strings braces hold an expression, `{{i+1}}`; a brace is `{found[0] * 2}`"
            reporter.report("UL010", start, end, message, hint)
            raise Panic
        parts.append(Text(plain, text.start, text.end))
        plain = ""
        parts.append(_expression(match.group(1), start + 1 if exact else start, reporter))
    parts.append(Text(plain + text.value[last:], text.start, text.end))
    return parts


def _expression(text: str, start: int, reporter: Reporter) -> Argument:
    source = Source("", text, start)
    reader = ExpressionReader(source, reporter, tokenize(reporter, source))
    found = reader.argument("a number")
    if reader.kinds[reader.i] != "end":
        raise reader.unexpected("an operator or the closing brace")
    return found
