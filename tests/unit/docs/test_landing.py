# SPDX-License-Identifier: BSD-3-Clause
"""The first page, the navigation and the glossary lead a reader to the first result and to each page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
README = (ROOT / "README.md").read_text("utf-8")
GLOSSARY = (ROOT / "docs" / "glossary.md").read_text("utf-8")
TERMS = re.findall(r"\*\*([^*]+)\*\*", GLOSSARY)
KINDS = ["Tutorials", "How-to guides", "Reference", "Explanation"]
LINK = re.compile(r"\]\(([^)#]+)")
SCREEN = 24  # lines


def navigation() -> dict[str, list[str]]:
    """Return the pages below each top entry of mkdocs.yml."""
    nav = (ROOT / "mkdocs.yml").read_text("utf-8").partition("\nnav:\n")[2]
    entries = re.findall(r"^  - ([^:\n]+):(.*\n(?:   .*\n)*)", nav, re.M)
    return {kind: re.findall(r"[\w./-]+\.md", inside) for kind, inside in entries}


def test_the_first_result_is_on_the_first_screen() -> None:
    first = README.splitlines()[:SCREEN]
    assert any(line.startswith("make demo") for line in first)
    assert any(line.startswith("![") for line in first), "the picture of what it gives"


def test_each_reader_is_told_what_to_read() -> None:
    table = README.partition("## Who should read what\n\n")[2].partition("\n\n")[0].splitlines()[2:]
    assert len(table) >= 6
    for row in table:
        reader, pages = row.strip("|").split("|")
        assert reader.strip() and LINK.findall(pages), row


def test_the_navigation_has_the_four_kinds() -> None:
    nav = navigation()
    assert list(nav) == ["Start", *KINDS]
    pages = [page for kind in nav.values() for page in kind]
    assert len(pages) > 50 and len(pages) == len(set(pages)), "a page twice"
    there = (page for page in pages if not page.startswith("docs/reference/"))  # pages that are generated
    assert not [page for page in there if not (ROOT / page).is_file()]


@pytest.mark.parametrize("kind", KINDS)
def test_the_readme_puts_a_page_where_the_navigation_does(kind: str) -> None:
    told = set(LINK.findall(README.partition(f"- **{kind}:**")[2].split("\n- **")[0].split("\n\n")[0]))
    assert len(told) > 4
    other = {page for name, pages in navigation().items() if name != kind for page in pages}
    assert not told & other, f"{kind} of the README"


def test_the_glossary_is_short() -> None:
    assert 20 < len(TERMS) == len(set(TERMS)) <= 40


def test_the_words_of_the_glossary_are_used() -> None:
    pages = [ROOT / "README.md", *(ROOT / "docs").rglob("*.md"), *(ROOT / "examples").rglob("*.md")]
    texts = [page.read_text("utf-8").lower() for page in pages if page.name != "glossary.md"]
    for term in TERMS:
        lower = term.lower()
        word = re.compile(rf"\b{re.escape(lower)}(s|es)?\b")
        assert sum(lower in text and bool(word.search(text)) for text in texts) >= 3, (
            f"{term}: in three pages, or no entry"
        )
