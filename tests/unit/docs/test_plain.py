# SPDX-License-Identifier: BSD-3-Clause
"""The sentences of pages, docstrings and comments are short, as tools/docs/plain.py measures them."""

from __future__ import annotations

import sys
from itertools import groupby
from pathlib import Path
from typing import NamedTuple

import pytest

# Last, because tools/docs has a reference.py too, which must not hide tests/reference/.
sys.path.append(str(Path(__file__).resolve().parents[3] / "tools" / "docs"))

import plain

ROOT = Path(__file__).resolve().parents[3]

FEW = 8  # a file with at most so many sentences may have longer ones


class Ceilings(NamedTuple):
    """The limits of the sentences of one kind.

    Lower a limit when the texts have become plainer. Never raise one.
    """

    folders: tuple[str, ...]
    mean: float  # words
    file_mean: float  # words, in a file with more than a few sentences
    semicolons: float  # share of the sentences that have one
    least: int  # the least number of sentences that the measurement must find


CEILINGS = {
    "pages": Ceilings((".",), 12, 15.5, 0.03, 3000),
    "python": Ceilings((".",), 10.5, 15, 0.03, 6000),
    "vhdl": Ceilings(("gateware", "components", "examples", "src"), 10.5, 15.5, 0.06, 2500),
    "c++": Ceilings(("native/include", "native/src", "components"), 10.5, 16.5, 0.1, 1000),
}

PAGE = """---
title: no sentence; it is front matter
---
# No sentence. It is a heading

The first one goes over
two lines. See [the second one](a.md "i.e. b. C"); it has `code. With; stops` in it.
Is `x` the third, e.g. This? It is.

<!-- No sentence here. Nor here. -->
- The fourth one is an item
- The fifth one; it goes
  over two lines

      no sentence here. Nor here.

  The sixth belongs to it.

| no | sentence here. Nor here. |
|----|----|

```sh
echo No sentence here. Nor here.
```
![No sentence of a picture](a.svg)
"""
SENTENCES = [
    (6, "The first one goes over two lines.", 7),
    (7, "See the second one; it has `code. With; stops` in it.", 9),
    (8, "Is `x` the third, e.g. This?", 6),
    (11, "The fourth one is an item", 6),
    (12, "The fifth one; it goes over two lines", 8),
    (17, "The sixth belongs to it.", 5),
]
MODULE = '''# SPDX-License-Identifier: BSD-3-Clause
"""Do the first thing.

Then do the second one:

    and not this one. Nor this one.
"""

x = "# no comment at all"  # the third one, beside code
# The fourth goes over
# two lines. Of the fifth this is all.


def f() -> None:
    """Return nothing at all.

    >>> f("not this one")
    'nor what it prints'

    \\b
    Nor a block that click prints unwrapped.
    Its second line neither.

    The sixth comes after them.
    """
    # pragma: no sentence, although it has many words
    print(
        """an argument is no docstring, although it begins a line"""
    )
    if print:
        x = """
    nor is a text with a name"""


class C:  # with a remark
    # and another one
    r"""Seventh, this is raw \\ text."""
'''

VHDL = """-- SPDX-License-Identifier: BSD-3-Clause
--
-- Counts the first clocks.
-- The second goes
-- over lines.
--
--   no --> sentence here
--
-- Ports     clock: the third one. reset, start: a fourth.
  a <= "-- no comment";  -- beside the code
  b <= '"';
  -- Over the code.
"""
IN_VHDL = [
    (3, "Counts the first clocks.", 4),
    (4, "The second goes over lines.", 5),
    (9, "Ports clock: the third one.", 5),
    (9, "reset, start: a fourth.", 4),
    (10, "beside the code", 3),
    (12, "Over the code.", 3),
]
CPP = """// A first one.
//
//     no(sentence, here);
#pragma once
/* A second one over
 * two lines. */
const char* a = "http://no.sentence of words";  ///< The third, beside code.
char b = '"';  // is it one
}  // namespace unitylink
"""
IN_CPP = [
    (1, "A first one.", 3),
    (5, "A second one over two lines.", 6),
    (7, "The third, beside code.", 4),
    (8, "is it one", 3),
]


@pytest.mark.parametrize("kind", CEILINGS)
def test_the_texts_are_plain(kind: str) -> None:
    most = CEILINGS[kind]
    read = plain.files([ROOT / folder for folder in most.folders], kind)
    every = [sentence for file in read for sentence in plain.sentences(file)]
    figures = plain.figures(every)
    assert figures.sentences > most.least
    told = f"`python tools/docs/plain.py --of {kind}` says which file"
    assert figures.mean <= most.mean, f"{figures.mean:.2f} words in a sentence; {told}"
    assert figures.semicolons <= most.semicolons, f"{figures.semicolons:.1%} with a semicolon; {told}"
    files = {file: plain.figures(group) for file, group in groupby(every, key=lambda one: one.file)}
    long = [str(file) for file, one in files.items() if one.sentences >= FEW and one.mean > most.file_mean]
    assert not long, f"more than {most.file_mean} words in a sentence"


def test_the_sentences_of_a_page(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(PAGE, "utf-8")
    assert [one[1:] for one in plain.sentences(page)] == SENTENCES
    assert plain.figures(plain.sentences(page)) == (6, 41 / 6, 2 / 6, 9)


def test_the_sentences_of_python(tmp_path: Path) -> None:
    module = tmp_path / "module.py"
    module.write_text(MODULE, "utf-8")
    assert [(one.line, one.text) for one in plain.sentences(module)] == [
        (2, "Do the first thing."),
        (4, "Then do the second one:"),
        (15, "Return nothing at all."),
        (24, "The sixth comes after them."),
        (37, "Seventh, this is raw \\ text."),
        (9, "the third one, beside code"),
        (10, "The fourth goes over two lines."),
        (11, "Of the fifth this is all."),
        (35, "with a remark"),
        (36, "and another one"),
    ]


@pytest.mark.parametrize(("suffix", "text", "expected"), [(".vhd", VHDL, IN_VHDL), (".hpp", CPP, IN_CPP)])
def test_the_sentences_of_comments(
    tmp_path: Path, suffix: str, text: str, expected: list[tuple[int, str, int]]
) -> None:
    source = tmp_path / f"source{suffix}"
    source.write_text(text, "utf-8")
    assert [one[1:] for one in plain.sentences(source)] == expected


def test_made_folders_are_not_read(tmp_path: Path) -> None:
    for name in ("a.md", "b/c.md", "build/d.md", ".venv/e.md", "b/f.py", "b/g.vhd", "b/h.hpp"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert [file.name for file in plain.files([tmp_path])] == ["a.md", "c.md"]
    assert [file.name for file in plain.files([tmp_path], "python")] == ["f.py"]
    assert [file.name for file in plain.files([tmp_path], "vhdl")] == ["g.vhd"]
    assert [file.name for file in plain.files([tmp_path], "c++")] == ["h.hpp"]
    assert [file.name for file in plain.files([tmp_path / "build"])] == ["d.md"]


def test_what_is_printed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.md"
    page.write_text(PAGE, "utf-8")
    monkeypatch.setattr(sys, "argv", ["plain.py", str(page)])
    plain.main()
    _, row, total = capsys.readouterr().out.splitlines()
    assert row.split() == ["6", "6.8", "33%", "9", str(page)]
    assert total.split() == ["6", "6.8", "33%", "9", "all"]
    drawn = []
    for seed in ("3", "3", "4"):
        monkeypatch.setattr(sys, "argv", ["plain.py", "--draw", "4", "--seed", seed, str(page)])
        plain.main()
        drawn.append(capsys.readouterr().out.splitlines())
    assert drawn[0] == drawn[1] != drawn[2]
    assert set(drawn[0]) < {f"{page}:{line}: {text}" for line, text, _ in SENTENCES}
