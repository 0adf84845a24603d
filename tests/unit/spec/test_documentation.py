# SPDX-License-Identifier: BSD-3-Clause
"""To what a `///` comment belongs. Each comment is looked at once, however many there are."""

from __future__ import annotations

import re

import pytest

from unitylink.spec import compile_text
from unitylink.spec.report.diagnostics import Reporter
from unitylink.spec.source import Source
from unitylink.spec.text import lexer


class Counted:
    """A pattern that counts how often a text is searched."""

    def __init__(self, pattern: re.Pattern[str]) -> None:
        self.pattern = pattern
        self.searches = 0

    def search(self, text: str, position: int) -> re.Match[str] | None:
        self.searches += 1
        return self.pattern.search(text, position)


def test_many_lines_after_one_token_are_searched_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """The time once grew with the square: a spec of 170,000 lines took 8 s."""
    counted = Counted(lexer._LINE_END)
    monkeypatch.setattr(lexer, "_LINE_END", counted)
    text = "public a() {\n" + "/// line\n" * 500 + "@x = 0x1: READ(); }"
    tokens = lexer.tokenize(Reporter(Source("a.ul", text)))
    (documentation,) = tokens.documentation.values()
    assert documentation == "\n".join(["line"] * 500)
    assert counted.searches == 1


@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_a_comment_belongs_to_what_stands_before_or_after_it(end: str) -> None:
    lines = [
        "/// the arm",
        "public a() {",
        "/// one",
        "/// two",
        "@x = 0x1: READ(); /// at hand",
        "}",
    ]
    spec = compile_text(end.join(lines), "a.ul").spec
    assert spec is not None
    assert spec.root().elements[0].documentation == "one\ntwo\nat hand"
    assert spec.root().documentation == "the arm"
