# SPDX-License-Identifier: BSD-3-Clause
"""How diagnostics are shown."""

from __future__ import annotations

from unitylink.spec import CODES, compile_text, render

TEXT = """public a() {
   @speed = 0x1: RAED();
   @unit = 0x1: READ(ID=n);
}
b(): @ (x) {
   @x: READ();
}
"""

REPORT = """\
error[UL010]: expected READ or WRITE after an address but found `RAED`
 --> robot.ul:2:18
  |
2 |    @speed = 0x1: RAED();
  |                  ^^^^
  = help: did you mean `READ`?

error[UL025]: `a` has no parameter `n`
 --> robot.ul:3:25
  |
3 |    @unit = 0x1: READ(ID=n);
  |                         ^
  = help: declare it: `a(n)`, or put text into quotes

2 errors
"""


def test_report() -> None:
    assert render(compile_text(TEXT, "robot.ul").diagnostics) == REPORT


def test_colors_change_nothing_else() -> None:
    colored = render(compile_text(TEXT, "robot.ul").diagnostics, color=True)
    assert "\x1b[1;31m" in colored
    for code in ("\x1b[1;31m", "\x1b[1;33m", "\x1b[1;34m", "\x1b[1m", "\x1b[0m"):
        colored = colored.replace(code, "")
    assert colored == REPORT


def test_json() -> None:
    diagnostic = compile_text(TEXT, "robot.ul").diagnostics[1]
    assert diagnostic.to_json() == {
        "severity": "error",
        "code": "UL025",
        "file": "robot.ul",
        "line": 3,
        "column": 25,
        "message": "`a` has no parameter `n`",
        "hint": "declare it: `a(n)`, or put text into quotes",
        "labels": [],
        "fixes": [],
    }


def test_summary_and_nothing() -> None:
    assert render(()) == ""
    warnings = compile_text("public a(x,y) { @z = 0x1: READ(); }").diagnostics
    assert render(warnings).endswith("\n2 warnings\n")
    mixed = compile_text(
        "public a(c) { TOSNET(CTRL=c); @z = 0x4: READ(); @y = 0x0: WRITE(); @x = 0x4: READ(); }"
    ).diagnostics
    assert render(mixed).endswith("\n1 error, 3 warnings\n")


def test_control_characters_of_a_file_do_not_reach_the_terminal() -> None:
    diagnostics = compile_text('public a() { @x: READ(ID="\x1b[31m\u202e"); \x07 }').diagnostics
    report = render(diagnostics)
    assert "\x1b" not in report
    assert "\x07" not in report
    assert "\u202e" not in report


def test_caret_stands_under_wide_and_combining_characters() -> None:
    text = 'public a() { @x = 0x1: READ(ID="\u6f22\u5b57e\u0301"+z); }'
    lines = render(compile_text(text).diagnostics).splitlines()
    # two characters take two columns each, and one takes none
    assert lines[3].index("z") + 2 - 1 == lines[4].index("^")


def test_codes_are_complete() -> None:
    assert list(CODES) == sorted(CODES)
    assert {code.severity for code in CODES.values()} == {"error", "warning"}
    assert all(code.title for code in CODES.values())
