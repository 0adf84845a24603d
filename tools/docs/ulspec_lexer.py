# SPDX-License-Identifier: BSD-3-Clause
"""The colours of UL-spec on the site: a Pygments lexer made of the editors' grammar. So both colour alike.

mkdocs loads it as a hook. Then it knows blocks of `ul` (whole specs) and `ulspec` (parts, and mistakes).
"""

from __future__ import annotations

import json
import re
import sys
from pathlib import Path
from typing import Any

from pygments.lexer import RegexLexer
from pygments.lexers import LEXERS
from pygments.token import Comment, Keyword, Name, Number, Punctuation, String, Text, _TokenType

__all__ = ["UlSpecLexer"]

GRAMMAR = Path(__file__).parents[2] / "editors/vscode/syntaxes/ulspec.tmLanguage.json"
_MODULE = "ulspec_lexer"

# The beginnings of scope names, with the longest first.
_TOKENS: dict[str, _TokenType] = {
    "comment.line.documentation": Comment.Special,
    "comment": Comment,
    "string": String,
    "constant.numeric": Number,
    "keyword.other.access": Keyword.Reserved,
    "keyword": Keyword,
    "support.type.property-name": Name.Constant,
    "storage.type": Keyword.Type,
    "entity.name.function.annotation": Name.Decorator,
    "entity.name.type": Name.Function,
    "variable.other.member": Name.Variable,
    "variable": Name,
    "punctuation": Punctuation,
}


def rules() -> list[Any]:
    """Return the grammar's patterns in the form of Pygments. Whatever matches none of them is text."""
    found: list[Any] = []
    for pattern in json.loads(GRAMMAR.read_text("utf-8"))["patterns"]:
        expression = pattern.get("match") or f"{pattern['begin']}[\\s\\S]*?{pattern['end']}"
        token = next(token for scope, token in _TOKENS.items() if pattern["name"].startswith(scope))
        found.append((expression, token))
    return [*found, (r"\s+", Text), (r".", Text)]


class UlSpecLexer(RegexLexer):
    """UL-spec with its mistakes. Nothing is marked as an error, because pages show mistakes on purpose."""

    name = "UL-spec"
    aliases = ("ul", "ulspec")
    filenames = ("*.ul",)
    flags = re.MULTILINE
    tokens = {"root": rules()}  # noqa: RUF012  as Pygments declares it


def on_startup(**_: object) -> None:
    """Register the lexer with Pygments. mkdocs calls this first."""
    sys.modules.setdefault(_MODULE, sys.modules[__name__])
    LEXERS["UlSpecLexer"] = (_MODULE, "UL-spec", UlSpecLexer.aliases, UlSpecLexer.filenames, ())
