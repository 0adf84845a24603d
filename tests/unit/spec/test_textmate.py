# SPDX-License-Identifier: BSD-3-Clause
"""The colours of editors: the TextMate grammar divides a text in the same way as the lexer.

Its patterns are simple enough for Python's `re`. They are applied here as in an editor: at each place, the
first one that matches.
"""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from unitylink.spec.report.diagnostics import Reporter
from unitylink.spec.source import Source
from unitylink.spec.text.lexer import KEYWORDS, tokenize

ROOT = Path(__file__).parents[3]
FOLDER = ROOT / "editors" / "vscode"
GRAMMAR = json.loads((FOLDER / "syntaxes" / "ulspec.tmLanguage.json").read_text("utf-8"))
EXAMPLES = sorted(ROOT.glob("examples/*/*.ul"))


def _pattern(rule: dict[str, str]) -> re.Pattern[str]:
    text = rule["match"] if "match" in rule else f"{rule['begin']}[\\s\\S]*?{rule['end']}"
    return re.compile(text, re.MULTILINE)


RULES = [(rule["name"].split(".")[0], _pattern(rule)) for rule in GRAMMAR["patterns"]]


def colours(text: str) -> list[tuple[int, int, str]]:
    """Return (start, end, first word of the scope) of every coloured piece, as an editor finds them."""
    found = []
    position = 0
    while position < len(text):
        matches = ((m, name) for name, rule in RULES if (m := rule.search(text, position)) and m.group())
        best = min(matches, key=lambda one: one[0].start(), default=None)
        if best is None:
            break
        match, name = best
        start = match.start() + len(match.group()) - len(match.group().lstrip())
        found.append((start, match.end(), name))
        position = match.end()
    return found


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda path: path.stem)
def test_colours_agree_with_the_lexer(path: Path) -> None:
    text = path.read_text("utf-8")
    tokens = tokenize(Reporter(Source(path.name, text)))
    coloured = colours(text)
    pieces = {start: (end, name) for start, end, name in coloured}
    for start, end in tokens.comments:
        assert pieces[start] == (end, "comment")
    kinds = {"string": {"string"}, "number": {"constant"}, "keyword": {"keyword", "storage", "support"}}
    for kind, start, end in zip(tokens.kinds, tokens.starts, tokens.ends, strict=True):
        if kind in kinds:
            found = pieces.get(start)
            assert found is not None and found[0] == end and found[1] in kinds[kind], text[start:end]
        elif kind not in ("end", "name"):
            # the @ of an annotation has the colour of its name
            names = ("punctuation", "variable", *(["entity"] if text[start] == "@" else []))
            assert any(a <= start < b and name in names for a, b, name in coloured), text[start:end]


@pytest.mark.parametrize("word", sorted(KEYWORDS))
def test_every_keyword_has_a_colour(word: str) -> None:
    text = f"{word}(" if word.isupper() else f"{word} x"
    assert colours(text)[0][:2] == (0, len(word))
    assert colours(text)[0][2] in ("keyword", "storage", "support")


def test_the_extension_is_whole() -> None:
    package = json.loads((FOLDER / "package.json").read_text("utf-8"))
    json.loads((FOLDER / "language-configuration.json").read_text("utf-8"))
    contributes = package["contributes"]
    named = [
        package["main"],
        contributes["languages"][0]["configuration"],
        contributes["grammars"][0]["path"],
    ]
    assert all((FOLDER / name).is_file() for name in named)
    assert contributes["grammars"][0]["scopeName"] == GRAMMAR["scopeName"]
    assert contributes["languages"][0]["id"] == contributes["grammars"][0]["language"] == "ulspec"
