# SPDX-License-Identifier: BSD-3-Clause
"""The sentences of the pages are short, as tools/docs/plain.py measures them; and that tool works."""

from __future__ import annotations

import sys
from itertools import groupby
from pathlib import Path

import pytest

# At the end: tools/docs has a reference.py too, which must not stand before tests/reference/.
sys.path.append(str(Path(__file__).resolve().parents[3] / "tools" / "docs"))

import plain

ROOT = Path(__file__).resolve().parents[3]

# Ceilings: lower them when the pages got plainer, never raise them.
MEAN_WORDS = 12
PAGE_MEAN_WORDS = 15.5  # of a page with more than a few sentences
FEW = 8
SEMICOLONS = 0.03  # share of the sentences

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
    """
'''


def test_the_pages_are_plain() -> None:
    every = [sentence for page in plain.files([ROOT]) for sentence in plain.sentences(page)]
    figures = plain.figures(every)
    assert figures.sentences > 3000
    told = "`python tools/docs/plain.py` says which page"
    assert figures.mean <= MEAN_WORDS, f"{figures.mean:.2f} words in a sentence; {told}"
    assert figures.semicolons <= SEMICOLONS, f"{figures.semicolons:.1%} with a semicolon; {told}"
    pages = {page: plain.figures(group) for page, group in groupby(every, key=lambda one: one.file)}
    long = [str(page) for page, one in pages.items() if one.sentences >= FEW and one.mean > PAGE_MEAN_WORDS]
    assert not long, f"more than {PAGE_MEAN_WORDS} words in a sentence"


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
        (9, "the third one, beside code"),
        (10, "The fourth goes over two lines."),
        (11, "Of the fifth this is all."),
    ]


def test_made_folders_are_not_read(tmp_path: Path) -> None:
    for name in ("a.md", "b/c.md", "build/d.md", ".venv/e.md", "b/f.py"):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        (tmp_path / name).touch()
    assert [file.name for file in plain.files([tmp_path])] == ["a.md", "c.md"]
    assert [file.name for file in plain.files([tmp_path], python=True)] == ["f.py"]
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
