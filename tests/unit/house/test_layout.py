# SPDX-License-Identifier: BSD-3-Clause
"""The layout of sources and pages: 120 columns, no tabs, no trailing blanks, VHDL in lower case."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import PurePosixPath

import pytest
from unit.house.files import files, text

COLUMNS = 120  # as in .clang-format and .mdformat.toml; ruff keeps Python at 110
KINDS = (".py", ".pyi", ".c", ".cpp", ".h", ".hpp", ".vhd", ".sh", ".lua", ".md", ".js", ".css", ".html")
KINDS += (".mjs", ".ts", ".tsx")
NAMES = ("Makefile", "CMakeLists.txt")
# Made files: by `unitylink generate`, where a name of a spec may have any length, and by `make page`.
MADE = ("tests/golden/", "src/unitylink/dashboard/page/")

PRAGMA = re.compile(r"  # (type: ignore|noqa).*$")  # ruff does not count it either
NO_CODE = re.compile(r'"[^"\n]*"|\'.\'|--[^\n]*|\d+#[0-9A-Fa-f_]+#')  # strings, characters, comments, numbers
PIECE = re.compile(r"!?\[[^\]]*\]\([^)]*\)|`[^`]*`")  # parts of a page: a link, a picture, code
CHARACTERS = {"NUL", "HT", "LF", "CR"}  # the names that VHDL's package `standard` gives them


def breakable(file: PurePosixPath, content: str) -> list[bool]:
    """Tell for each line whether it could be broken.

    On a page, code, tables and headings cannot be broken. Neither can a link, a picture or code within a
    line.
    """
    lines = content.split("\n")
    if file.suffix != ".md":
        return [True] * len(lines)
    found, fenced = [], False
    for line in lines:
        mark = line.lstrip().startswith("```")
        fenced ^= mark
        words = re.sub(r"^[-*\d.]+ +", "", PIECE.sub("x", line.strip()))
        found.append(not (fenced or mark or words.startswith(("|", "#"))) and " " in words)
    return found


def faults(file: PurePosixPath, content: str) -> Iterator[str]:
    """Yield each fault in the layout of a source, with its line."""
    lines = zip(content.split("\n"), breakable(file, content), strict=True)
    for number, (line, can_be_broken) in enumerate(lines, 1):
        if len(line) > COLUMNS and can_be_broken and len(PRAGMA.sub("", line)) > COLUMNS:
            yield f"{file}:{number}: {len(line)} columns, more than {COLUMNS}"
        if "\t" in line.removeprefix("\t" if file.name == "Makefile" else ""):
            yield f"{file}:{number}: a tab"
        if line != line.rstrip():
            yield f"{file}:{number}: blanks at the end"
        if file.suffix == ".vhd" and line != line.lower():
            words = set(re.findall(r"\b[A-Za-z]\w*", NO_CODE.sub(" ", line)))
            yield from (
                f"{file}:{number}: {word} is not in lower case"
                for word in words - CHARACTERS
                if word != word.lower()
            )
    if content and (not content.endswith("\n") or content.endswith("\n\n")):
        yield f"{file}: not one newline at the end"


def test_every_source_is_laid_out() -> None:
    sources = [
        file
        for file in files()
        if (file.suffix in KINDS or file.name in NAMES) and not str(file).startswith(MADE)
    ]
    assert {file.suffix or file.name for file in sources} >= {*KINDS, "Makefile"}
    found = [fault for file in sources for fault in faults(file, text(file))]
    assert not found, "\n".join(found)


@pytest.mark.parametrize(
    ("line", "fault"),
    [
        ("-- " + "é" * 117, ""),
        ("-- " + "é" * 118, "a.vhd:2: 121 columns, more than 120"),
        ("\ta <= b;", "a.vhd:2: a tab"),
        ("a <= b; ", "a.vhd:2: blanks at the end"),
        ("Signal a : std_ulogic;", "a.vhd:2: Signal is not in lower case"),
        ("""a <= x"0A" & LF & 'U' & to(16#A0#);  -- Of "B".""", ""),
        ("a <= b;\n", "a.vhd: not one newline at the end"),
    ],
)
def test_a_fault_of_the_layout_is_reported(line: str, fault: str) -> None:
    assert list(faults(PurePosixPath("a.vhd"), f"a <= b;\n{line}\n")) == ([fault] if fault else [])


def test_a_pragma_makes_no_line_too_long() -> None:
    line = "x = " + "1" * 116
    assert not list(faults(PurePosixPath("a.py"), f"{line}  # type: ignore[assignment]\n"))
    assert list(faults(PurePosixPath("a.py"), f"{line}  # why it is so\n"))


def test_what_cannot_be_broken_may_be_long() -> None:
    word, row = "w" * 130, "w " * 65 + "w"
    page = f"# {row}\n\n- `{row}`.\n\n| {row} |\n\n![{row}](a.svg)\n\n```\n{row}\n```\n\n{word}\n"
    assert not list(faults(PurePosixPath("a.md"), page))
    assert list(faults(PurePosixPath("a.md"), f"{page}\n`a` {row}\n")) == [
        "a.md:15: 135 columns, more than 120"
    ]
