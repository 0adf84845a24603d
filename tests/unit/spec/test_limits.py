# SPDX-License-Identifier: BSD-3-Clause
"""Texts that try to exhaust time, memory or the stack: each ends with a diagnostic.

(`make bench` measures how fast)
"""

from __future__ import annotations

import pytest

from unitylink.spec import compile_text, format_text, render
from unitylink.spec.isochrony.latency import publishes_of
from unitylink.spec.report.diagnostics import KEPT, SHOWN


def codes(text: str) -> set[str]:
    result = compile_text(text)
    assert len(render(result.diagnostics)) < 200_000
    return {d.code for d in result.diagnostics}


def test_flat_spec_of_10000_statements() -> None:
    members = "".join(f'   @r{i} = 0x{i:X}: signed READ(ID="register {i}", CRC);\n' for i in range(10_000))
    spec = compile_text(f"public flat() {{\n{members}}}\n").spec
    assert spec is not None
    assert [element.address for _, element in spec.walk()] == list(range(10_000))


def test_exponential_expansion() -> None:
    levels = "".join(f"a{i}() {{ a: a{i + 1}(); b: a{i + 1}(); }}\n" for i in range(60))
    assert codes(f"public {levels} a60() {{ @x = 0x1: READ(); }}") == {"UL038"}
    assert codes(f"public {levels} a60() {{ }}") == {"UL038"}  # it has no element at all


def test_more_constructors_than_are_read() -> None:
    assert codes("public a() { }" + "".join(f"c{i}() {{ }}" for i in range(20_000))) == {"UL003"}


def test_more_tokens_or_comments_than_are_read() -> None:
    assert codes("public a() {" + "/**/" * 370_000) == {"UL003"}
    assert codes("public a() {" + "@x=0x1:READ();" * 46_000) == {"UL003", "UL021"} | {"UL000"}


def test_exponential_groups() -> None:
    groups = "".join(f"g{i + 1} = g{i}, g{i};" for i in range(60))
    assert codes(f"public a() {{ @x = 0x1: READ(); g0 = x; {groups} }}") == {"UL038"}


def test_exponential_strings() -> None:
    levels = "".join(f"a{i}(n): @v {{ @v: a{i + 1}(n+n); }}\n" for i in range(60))
    text = f'public r() {{ a: a0("x") @v=0x1; }} {levels} a60(n): @v {{ @v: READ(ID=n); }}'
    assert codes(text) == {"UL040"}


def test_unknown_names_in_many_groups() -> None:
    text = "public a() {" + "".join(f"g{i} = q{i};" for i in range(10_000)) + "}"
    assert codes(text) == {"UL027", "UL000"}


def test_long_chains() -> None:
    chain = "".join(f"c{i}() {{ x: c{i + 1}(); }}" for i in range(5000))
    assert codes(f"{chain} c5000() {{ }} public r() {{ x: c0(); }}") == {"UL039"}
    assert codes(f"{chain} c5000() {{ x: c0(); }} public r() {{ x: c0(); }}") >= {"UL034"}
    groups = "".join(f"g{i} = g{i + 1};" for i in range(5000))
    spec = compile_text(f"public r() {{ {groups} g5000 = x; @x = 0x1: READ(); }}").spec
    assert spec is not None
    assert len(spec.root().groups[0].elements) == 1


def test_repeated_garbage() -> None:
    units = ["@", "{", "}", "(", "a(b,", "public ", "x;", "@x", "a:b(", '"', "'a", "/*", "§ ", "\\", "0x"]
    for unit in (*units, "=", "+a"):
        for frame in ("", "public a() { "):
            assert codes(frame + unit * (10_000 // len(unit))), (unit, frame)


def test_more_diagnostics_than_are_kept() -> None:
    diagnostics = compile_text("public a() {" + "@x;\n" * 5000 + "}").diagnostics
    assert len(diagnostics) == KEPT + 1
    assert diagnostics[-1].code == "UL000"
    report = render(diagnostics)
    assert report.count("-->") == SHOWN
    assert "... and 901 more" in report
    assert report.endswith("1,001 errors\n")


def test_long_line_is_shown_around_the_caret() -> None:
    text = "public a() {" + " " * 5000 + "@x: READ();" + " " * 5000 + "}"
    diagnostic = compile_text(text).diagnostics[0]
    assert diagnostic.span.column == 5014
    assert len(diagnostic.excerpt) < 200
    assert diagnostic.excerpt[diagnostic.caret] == "x"


def test_formatter_of_a_long_text() -> None:
    text = "public a() {\n" + "".join(f"   @r{i} = 0x{i:X}: READ();\n" for i in range(5000)) + "}\n"
    assert format_text(text) == text


def _on_change(count: int, head: str = "") -> str:
    words = "".join(f"   @x{i} = 0x{i:X}: READ(PUBLISH(on change));\n" for i in range(count))
    return f"{head}public a() {{\n{words}}}\n"


@pytest.mark.parametrize(("head", "most"), [("", 60), ("link l (DATA=16);\n", 121)])
def test_what_one_event_publishes_is_one_frame(head: str, most: int) -> None:
    fits = compile_text(_on_change(most, head))
    assert fits.spec is not None
    (device,) = fits.spec.devices
    assert publishes_of(len(device.groups[0].addresses), device.link.data_bits, "framed") == [most]
    beyond = compile_text(_on_change(most + 1, head))
    told = [one for one in beyond.diagnostics if one.code == "UL065"]
    assert beyond.spec is None and [one.span.line for one in told] == [most + 2 + bool(head)]
    assert f"{most + 1} words publish `on change`; a frame carries {most}" in told[0].message


def test_of_a_rate_there_may_be_several_frames() -> None:
    assert compile_text(_on_change(61).replace("on change", "1,10")).spec is not None
