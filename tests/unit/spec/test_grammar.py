# SPDX-License-Identifier: BSD-3-Clause
"""The parser and the reference grammar, ul.lark, agree about which texts are specs.

Both get the valid specs of the project and random mutations of them: tokens removed, doubled, swapped,
replaced and inserted.
"""

from __future__ import annotations

import random
import re
from pathlib import Path

import pytest
from effort import many
from lark import Lark
from lark.exceptions import UnexpectedInput

from unitylink.spec import CODES, Diagnostic, compile_text
from unitylink.spec.report.diagnostics import Reporter
from unitylink.spec.report.explain import explain
from unitylink.spec.source import Source
from unitylink.spec.text.lexer import KEYWORDS, tokenize

HERE = Path(__file__).parent
ROOT = HERE.parents[2]
GRAMMAR = (HERE / "ul.lark").read_text("utf-8")
PAGE = (ROOT / "docs" / "ul-spec.md").read_text("utf-8")
RIGHT = [
    *(path.read_text("utf-8") for path in sorted(ROOT.glob("examples/*/*.ul"))),
    *re.findall(r"```ul\n(.*?)```", PAGE, re.DOTALL),
    *(explain(code).mended for code in CODES if explain(code).mended),
]
MUTATIONS = many(1_200)

# Codes of form that no grammar of this kind can express. See the head of ul.lark.
_LENGTHS_AND_PLACES = {"UL003", "UL009", "UL016", "UL017", "UL018", "UL019", "UL045"}
_LAST_OF_FORM = "UL019"
_ONE_NUMBER = ("the divisor of the base publish frequency", "a rate with its unit")  # of a PUBLISH


@pytest.fixture(scope="module")
def grammar() -> Lark:
    return Lark(GRAMMAR, start="spec", parser="lalr", lexer="contextual")


def grammar_accepts(grammar: Lark, text: str) -> bool:
    try:
        grammar.parse(text)
    except UnexpectedInput:
        return False
    return True


def faults_of_form(text: str) -> list[Diagnostic]:
    """Return the parser's complaints about the form of a text, without those that no grammar covers."""
    return [
        diagnostic
        for diagnostic in compile_text(text).diagnostics
        if diagnostic.code <= _LAST_OF_FORM and diagnostic.code not in _LENGTHS_AND_PLACES
    ]


def tokens_of(text: str) -> list[str]:
    """Return the tokens of a valid text as they are written, without comments."""
    tokens = tokenize(Reporter(Source("x.ul", text)))
    count = tokens.kinds.index("end")
    return [text[tokens.starts[i] : tokens.ends[i]] for i in range(count)]


def likeness(token: str) -> str:
    """Return the rough kind of a token: its first character, but one kind for all letters and one for all
    digits.
    """
    return "a" if token[0].isalpha() else "0" if token[0].isdigit() else token[0]


def test_right_specs_are_right_for_both(grammar: Lark) -> None:
    assert len(RIGHT) > 100
    for text in RIGHT:
        assert faults_of_form(text) == [], text
        assert grammar_accepts(grammar, text), text


def test_wrong_examples_are_wrong_for_both(grammar: Lark) -> None:
    wrong = {code: explain(code).wrong for code in CODES if code <= _LAST_OF_FORM and explain(code).wrong}
    assert len(wrong) > 10
    for code, text in wrong.items():
        assert grammar_accepts(grammar, text) == (code in _LENGTHS_AND_PLACES), code


@pytest.mark.many
def test_mutations_are_judged_alike(grammar: Lark) -> None:
    chance = random.Random(2013)
    corpus = [tokens for text in RIGHT if (tokens := tokens_of(text)) and len(tokens) < 250]
    words = sorted({token for tokens in corpus for token in tokens})
    alike: dict[str, list[str]] = {}
    for word in words:
        alike.setdefault(likeness(word), []).append(word)
    accepted = 0
    for _ in range(MUTATIONS):
        tokens = list(chance.choice(corpus))
        for _ in range(chance.choice((1, 1, 1, 2, 3))):
            at = chance.randrange(len(tokens))
            kind = chance.randrange(7)
            if kind == 0:
                del tokens[at : at + 1]
            elif kind == 1:
                tokens.insert(at, tokens[at])
            elif kind == 2:
                other = chance.randrange(len(tokens))
                tokens[at], tokens[other] = tokens[other], tokens[at]
            elif kind == 3:
                tokens[at] = chance.choice(words)
            elif kind == 4:
                tokens.insert(at, chance.choice(words))
            else:
                tokens[at] = chance.choice(alike[likeness(tokens[at])])
            if not tokens:
                break
        text = " ".join(tokens)
        faults = faults_of_form(text)
        if any(said in fault.message for said in _ONE_NUMBER for fault in faults):
            continue  # PUBLISH with one number, for which the unit decides whether it is valid
        said = grammar_accepts(grammar, text)
        assert said == (not faults), f"{text}\ngrammar: {said}; parser: {[f.message for f in faults]}"
        accepted += said
    assert MUTATIONS // 20 < accepted < MUTATIONS // 2  # so both cases are really tried


def test_the_grammar_knows_the_keywords() -> None:
    reserved = re.search(r"^NAME: .*\?!\(([^)]*)\)", GRAMMAR, re.MULTILINE)
    assert reserved is not None
    assert set(reserved[1].split("|")) == KEYWORDS


def test_an_access_word_may_stand_where_a_type_does(grammar: Lark) -> None:
    """There is no such type, but that is no fault of form."""
    text = "public a() { @x = 0x1: READWRITE READ(); }"
    assert grammar_accepts(grammar, text)
    assert faults_of_form(text) == []
    assert [found.code for found in compile_text(text).diagnostics] == ["UL080"]
