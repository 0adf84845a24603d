# SPDX-License-Identifier: BSD-3-Clause
"""Every diagnostic code has a spec that gives only this code, at one place. The mended spec gives none.

The specs are those of src/unitylink/spec/report/explanations. Those too long for a page are built here.
"""

from __future__ import annotations

from pathlib import Path

import pytest

import unitylink.spec
from unitylink.spec import CODES, Result, compile_file, compile_text
from unitylink.spec.report.explain import explain

SHOWN = [code for code in CODES if explain(code).wrong]


def _flat(*members: str) -> str:
    return "public a() {\n" + "".join(f"   {member}\n" for member in members) + "}\n"


def _reads(count: int, divisor: str) -> list[str]:
    return [f"@x{i} = 0x{i:X}: READ(PUBLISH(1,{divisor or i + 1}));" for i in range(count)]


def _ten_times(levels: int) -> str:
    bodies = [" ".join(f"m{i}: c{level + 1}();" for i in range(10)) for level in range(levels)]
    return "public " + "".join(f"c{level}() {{ {body} }}\n" for level, body in enumerate(bodies))


def _nested(levels: int) -> str:
    return "public " + "".join(f"c{level}() {{ c: c{level + 1}(); }}\n" for level in range(levels))


# code -> (text, (line, column), other codes that it also gives), for texts that are too long for a file
BUILT: dict[str, tuple[str | bytes, tuple[int, int], set[str]]] = {
    "UL000": (_flat("@;" * 1200), (2, 2003), {"UL010"}),
    "UL002": (_flat('@x = 0x1: READ(ID="speed in µm/s");').encode("latin-1"), (2, 32), set()),
    "UL003": (" " * (2 * 1024 * 1024 + 1), (1, 1), set()),
    "UL038": (_ten_times(5) + "c5() { @x = 0x1: READ(); }", (1, 8), set()),
    "UL039": (_nested(65) + "c65() { @x = 0x1: READ(); }", (1, 8), set()),
    "UL064": (_flat(*_reads(32, "10")), (33, 5), set()),
    "UL065": (_flat(*_reads(256, "10")), (257, 5), set()),
    "UL066": (_flat(*_reads(17, "")), (18, 5), set()),
    "UL067": (_flat(*_reads(257, "")), (258, 5), {"UL066"}),
    "UL068": (
        _flat("all = p;", "p: p();") + "p() {" + "".join(f"@x{i}=0x{i:X}:READ();" for i in range(256)) + "}",
        (2, 4),
        set(),
    ),
}


def _only(result: Result, code: str, place: tuple[int, int]) -> None:
    assert [d.code for d in result.diagnostics] == [code]
    diagnostic = result.diagnostics[0]
    assert (diagnostic.span.line, diagnostic.span.column) == place, code
    assert diagnostic.severity == CODES[code].severity, code
    assert (result.spec is None) == (diagnostic.severity == "error"), code


def test_wrong_example_gives_its_code_and_nothing_else() -> None:
    for code in SHOWN:
        page = explain(code)
        result = compile_text(page.wrong)
        _only(result, code, (page.line, page.column))
        span = result.diagnostics[0].span
        assert max(1, span.end - span.start) == page.width, code
        # for this code, the message itself says what was expected
        assert result.diagnostics[0].hint or code == "UL010"


def test_mended_example_is_without_diagnostic() -> None:
    assert {code: found for code in SHOWN if (found := compile_text(explain(code).mended).diagnostics)} == {}


@pytest.mark.parametrize("code", BUILT)
def test_long_text_gives_its_code(code: str) -> None:
    text, place, also = BUILT[code]
    diagnostics = compile_text(text).diagnostics
    assert {d.code for d in diagnostics} == {code, *also}
    ours = [d for d in diagnostics if d.code == code]
    assert [(d.span.line, d.span.column) for d in ours] == [place]


def test_file_that_is_not_there(tmp_path: Path) -> None:
    _only(compile_file(tmp_path / "none.ul"), "UL001", (1, 1))
    _only(compile_file(tmp_path), "UL001", (1, 1))
    _only(compile_file("a\0b.ul"), "UL001", (1, 1))


def test_file_that_imports_itself(tmp_path: Path) -> None:
    (tmp_path / "a.ul").write_text('import "b.ul";\npublic a() { x: b(); }\n')
    (tmp_path / "b.ul").write_text('import "a.ul";\nb() { @x = 0x1: READ(); }\n')
    result = compile_file(tmp_path / "a.ul")
    _only(result, "UL043", (1, 8))
    assert result.diagnostics[0].span.file == str(tmp_path / "b.ul")
    assert "a.ul → b.ul → a.ul" in result.diagnostics[0].message


def test_every_code_has_an_example() -> None:
    assert set(CODES) == {*SHOWN, *BUILT, "UL001", "UL043"}


def test_every_page_is_a_code() -> None:
    folder = Path(unitylink.spec.__file__).parent / "report" / "explanations"
    assert {page.stem for page in folder.glob("*.md")} == {*CODES, "README"}


def test_pages_have_their_form() -> None:
    for code in CODES:
        text = explain(code).text
        assert len(text) > 20 and "```" not in text
        assert max(map(len, text.splitlines())) <= 130
