# SPDX-License-Identifier: BSD-3-Clause
"""docs/ul-spec.md is true: its specs compile, and its list of diagnostics has the compiler's own messages.

`python tests/unit/spec/test_docs.py` writes this list again.
"""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from unitylink.spec import CODES, Diagnostic, compile_text, format_text, render
from unitylink.spec.fix import fix_text
from unitylink.spec.report.explain import explain

ROOT = Path(__file__).parents[3]
PAGE = ROOT / "docs" / "ul-spec.md"
MARK = "<!-- what follows is written by `python tests/unit/spec/test_docs.py` -->\n\n"


def entry(code: str, diagnostic: Diagnostic | None) -> str:
    """Return the part of the page about one code."""
    text = f"### {code}: {CODES[code].title} ({CODES[code].severity})\n"
    if diagnostic is None:
        return f"{text}\n{explain(code).text}\n"
    indent = len(diagnostic.excerpt) - len(diagnostic.excerpt.lstrip())
    line = diagnostic.excerpt.strip()
    caret = " " * (diagnostic.caret - indent) + "^" * diagnostic.width
    shown = f"{line}\n{caret} {diagnostic.message}" if len(line) < 90 else diagnostic.message
    if diagnostic.hint:
        shown += f"\nhelp: {diagnostic.hint}"
    return f"{text}\n```ulspec\n{shown}\n```\n"


def section() -> str:
    """Return the list of all diagnostics, from the examples of their explanations."""
    parts = []
    for code in CODES:
        wrong = explain(code).wrong
        parts.append(entry(code, compile_text(wrong).diagnostics[0] if wrong else None))
    return "\n".join(parts)


def test_diagnostics_section_is_up_to_date() -> None:
    assert PAGE.read_text("utf-8").split(MARK)[1] == section()


def test_example_specs_are_without_diagnostic_and_formatted_as_shown() -> None:
    blocks = re.findall(r"```ul\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    assert len(blocks) >= 4
    for block in blocks:
        assert compile_text(block).diagnostics == ()
        if not re.search(r"\{ .* \}", block):  # constructors in one line save space on the page
            assert format_text(block) == block


def test_example_of_mistakes(tmp_path: Path) -> None:
    page = PAGE.read_text("utf-8").split(MARK)[0]
    (text,) = re.findall(r"```ulspec\n// arm\.ul, with five mistakes\n(.*?)```", page, re.DOTALL)
    (report,) = re.findall(r"```console\n\$ unitylink check arm\.ul\n(.*?)```", page, re.DOTALL)
    result = compile_text(text, "arm.ul")
    assert render(result.diagnostics) == report and result.errors == 5
    fixed = fix_text(text, "arm.ul")
    assert len(fixed.made) == 3 and fixed.result.errors == 2


def test_example_from_python(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = PAGE.read_text("utf-8").split(MARK)[0]
    (code,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    (tmp_path / "scara.ul").write_text((ROOT / "examples" / "scara" / "scara.ul").read_text("utf-8"))
    monkeypatch.chdir(tmp_path)
    told: list[str] = []
    exec(code, {"print": lambda *parts: told.append(" ".join(map(str, parts)))})
    assert "j1.cpos 0x88 READ" in told and "   @on = 0x10: WRITE();" in told[-1]


def test_example_of_an_import(tmp_path: Path) -> None:
    page = PAGE.read_text("utf-8").split(MARK)[0]
    (name, imported), *others = re.findall(r"\n\n```ulspec\n// (\w+\.ul)\n(.*?)```", page, re.DOTALL)
    (importing,) = re.findall(r"\n\n```ulspec\n(import .*?)```", page, re.DOTALL)
    assert not others
    (tmp_path / name).write_text(imported)
    assert compile_text(importing, str(tmp_path / "arm.ul")).diagnostics == ()
    assert format_text(importing) == importing and format_text(imported) == imported


def test_example_specs_of_the_page_and_of_examples_agree() -> None:
    scara = (ROOT / "examples" / "scara" / "scara.ul").read_text("utf-8")
    assert f"```ul\n{scara}```" in PAGE.read_text("utf-8")


if __name__ == "__main__":
    PAGE.write_text(PAGE.read_text("utf-8").split(MARK)[0] + MARK + section(), "utf-8")
