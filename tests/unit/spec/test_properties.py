# SPDX-License-Identifier: BSD-3-Clause
"""Properties of every text: no crash, and diagnostics lie inside the text.

The formatter keeps the meaning.
"""

from __future__ import annotations

import dataclasses
import random
import re
from pathlib import Path

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.errors import SpecError
from unitylink.spec import CODES, Diagnostic, Instance, Spec, compile_text, format_text, render
from unitylink.spec.report.explain import explain

ROOT = Path(__file__).parents[3]
WORDS = re.split(
    " ",
    "link public TOSNET CTRL BASE COMM UART READ WRITE ID CRC PUBLISH ALL signed ^READ a b joint x i "
    '0x1 0xFFFFFFFFF 10 1 0 12ab 0x 0.5 1e9 30deg 1<<64 1/0 1/3 "s" \'s\' "s \'s "{i}" "../x" '
    "// /// /* */ @ ( ) { } [ ] , ; : = . .. + - * / % << >> & | § \\ \n \r \0 \ufeff "
    "const enum bits open import fixed(8,8) u8 i16 u65 READWRITE W1C PULSE READCLEAR on change 10 Hz "
    'UNIT="rad" MIN=-1 MAX=2 SCALE=0 GROUP=g MEMORY() FIFO(BASE=0) @ros(x=1) pwm(channels=2) '
    "DOUBLE_BUFFER(SIZE=4) FIFO(DEPTH=8) arrival gpio(pins=-1)",
)


def mutated(seed: int, corpus: list[str]) -> str:
    """Return a text of the corpus with one to four mutations: a part is removed, inserted, or taken from
    another text.
    """
    chance = random.Random(seed)
    text = chance.choice(corpus)
    for _ in range(chance.randrange(1, 5)):
        at = chance.randrange(len(text) + 1)
        to = min(len(text), at + chance.choice((0, 0, 1, 3, chance.randrange(30))))
        other = chance.choice(corpus)
        start = chance.randrange(len(other))
        choices = (
            "",
            chance.choice(WORDS),
            other[start : start + chance.randrange(60)],
            chance.choice("@{}[]();:=,.'\"/*-+"),
        )
        text = text[:at] + chance.choice(choices) + text[to:]
    return text


def corpus() -> list[str]:
    """Return the texts that are mutated: examples, every construct, and every mistake."""
    files = [*sorted(ROOT.glob("examples/*/*.ul")), Path(__file__).with_name("everything.ul")]
    texts = [path.read_text("utf-8") for path in files]
    return texts + [explain(code).wrong for code in CODES if explain(code).wrong]


TEXTS = corpus()


def check(text: str) -> None:
    """Compile, render and format. Check that every result is possible."""
    result = compile_text(text, "x.ul")
    lines = re.split(r"\r\n?|\n", text)
    for diagnostic in result.diagnostics:
        inside(diagnostic, text, lines)
    assert (result.spec is None) == any(d.severity == "error" for d in result.diagnostics)
    assert bool(render(result.diagnostics)) == bool(result.diagnostics)
    if result.spec is not None:
        formatted = format_text(text, "x.ul")
        assert format_text(formatted, "x.ul") == formatted
        assert meaning(formatted) == meaning(text)
        assert words(formatted) == words(text)
    else:
        try:
            formatted = format_text(text)
        except SpecError as error:
            assert error.diagnostics
        else:
            assert format_text(formatted) == formatted


def inside(diagnostic: Diagnostic, text: str, lines: list[str]) -> None:
    span = diagnostic.span
    assert 0 <= span.start <= span.end <= len(text)
    assert 1 <= span.line <= len(lines)
    assert 1 <= span.column <= len(lines[span.line - 1]) + 1
    assert 0 <= diagnostic.caret <= len(diagnostic.excerpt)


def meaning(text: str) -> Spec:
    """Return the model without its places in the text."""
    spec = compile_text(text, "x.ul").spec
    assert spec is not None
    return dataclasses.replace(spec, roots=tuple(_bare(root) for root in spec.roots), devices=())


def _bare(instance: Instance) -> Instance:
    bare: list[object] = []
    for member in instance.members:
        if isinstance(member, Instance):
            bare.append(_bare(member))
        elif hasattr(member, "elements"):
            bare.append((member.name, member.path, [element.path for element in member.elements]))
        else:
            bare.append(dataclasses.replace(member, span=instance.span.__class__("", 0, 0, 0, 0)))
    return dataclasses.replace(instance, members=tuple(bare), span=instance.span.__class__("", 0, 0, 0, 0))


def words(text: str) -> list[str]:
    """Return everything but white space. Comments are included, without the white space in them."""
    return re.sub(r"\s", "", text.removeprefix("\ufeff")).split()


@given(st.text(max_size=200))
@settings(max_examples=many(200), deadline=None)
def test_arbitrary_text(text: str) -> None:
    check(text)


@given(st.binary(max_size=200))
@settings(max_examples=many(100), deadline=None)
def test_arbitrary_bytes(data: bytes) -> None:
    result = compile_text(data)
    assert result.spec is not None or result.diagnostics


@given(st.lists(st.sampled_from(WORDS), max_size=60).map(" ".join))
@settings(max_examples=many(200), deadline=None)
def test_arbitrary_words(text: str) -> None:
    check(text)
    check("public a(x): @ (y) { " + text)


@given(st.integers(0, 2**32))
@settings(max_examples=many(250), deadline=None)
def test_mutated_specs(seed: int) -> None:
    check(mutated(seed, TEXTS))


# --- generated valid specs ----------------------------------------------------------------------------------

_NAMES = st.from_regex(r"\A[a-z_][A-Za-z_0-9]{0,8}\Z").filter(
    lambda name: name not in ("link", "public", "signed")
)
_SPACES = ["", " ", "\n", "\t", "\n\n\n", " // note\n", "/* a */", "  /* a\n b */\n"]


@st.composite
def specs(draw: st.DrawFn) -> list[str]:
    """Draw the tokens of a valid spec: public constructor, expansions of tuples and vectors, elements,
    groups.
    """
    count = draw(st.integers(1, 4))
    names = draw(st.lists(_NAMES, min_size=8, max_size=8, unique=True))
    leg, pair, root, a, b, x, y, n = names
    next_address = iter(range(1000))

    def address() -> str:
        return f"0x{next(next_address):X}"

    out = [leg, "(", n, ")", ":", "@", "(", a, ",", b, ")", "{"]
    for name in (a, b):
        access = draw(st.sampled_from(["READ", "WRITE"]))
        properties = [["ID", "=", n, "+", '":x"'], ["CRC"]]
        if access == "READ":
            properties.append(["PUBLISH", "(", str(draw(st.integers(1, 2))), ",", "10", ")"])
        chosen = draw(st.permutations(properties))[: draw(st.integers(0, 3))]
        if name == a and ["ID"] not in [p[:1] for p in chosen]:
            chosen = [*chosen[:2], properties[0]]
        out += ["@", name, ":", *draw(st.sampled_from([[], ["signed"]])), access, "("]
        out += [token for i, p in enumerate(chosen) for token in ([","] if i else []) + p] + [")", ";"]
    out += ["}", pair, "(", ")", ":", "@", x, ",", "@", y, "{", "@", x, ":", leg, "(", "'l'", ")", ";"]
    out += ["@", y, ":", leg, "(", '"r"', ")", ";", "}", "public", root, "(", ")", "{"]
    for i in range(count):
        vectors = [["(", address(), ",", address(), ")"] for _ in range(2)]
        named = draw(st.booleans())
        bound = [
            ["@", *([v, "="] if named else []), *vector] for v, vector in zip((x, y), vectors, strict=True)
        ]
        out += [f"p{i}", ":", pair, "(", ")", *bound[0], ",", *bound[1], ";"]
    out += ["@", "fixed", "=", address(), ":", "READ", "(", ")", ";"]
    out += ["all_", "=", "ALL", "(", pair, ")", ".", x, ".", a, ",", "fixed", ",", "p0", ".", y, ";", "}"]
    return out


@given(specs(), st.integers(0, 2**32))
@settings(max_examples=many(60), deadline=None)
def test_generated_specs_compile_and_format(tokens: list[str], seed: int) -> None:
    chance = random.Random(seed)  # drawing each space from hypothesis takes longer than all the rest
    text = ""
    for token in tokens:
        space = chance.choice(_SPACES)
        if not space and re.match(r"\w", token) and re.search(r"\w\Z", text):
            space = " "
        text += space + token
    result = compile_text(text)
    assert [d for d in result.diagnostics if d.severity == "error"] == []
    check(text)
    comments = re.compile(r"//[^\n]*|/\*.*?\*/", re.DOTALL)
    kept = [comment.strip() for comment in comments.findall(format_text(text))]
    assert kept == [comment.strip() for comment in comments.findall(text)]


@pytest.mark.many
def test_every_prefix_ends_with_diagnostics_inside() -> None:
    for text in TEXTS:
        ends = range(0, min(len(text), 1500), 23)
        for end in random.Random(len(text)).sample(ends, many(len(ends))):
            check(text[:end])
