# SPDX-License-Identifier: BSD-3-Clause
"""Every relative link, heading anchor and named file of the documents exists."""

from __future__ import annotations

import re
from functools import cache
from pathlib import Path

from unit.house.files import ROOT, files

LINK = re.compile(r"!?\[[^\]]*\]\(([^)\s]+)\)")
FILE_AS_TEXT = re.compile(r"(?<!!)\[`?([\w./-]+\.(?:md|json|py|ul|toml|html))`?\]\(")
FENCE = re.compile(r"^```.*?^```", re.M | re.S)


@cache
def anchors(page: Path) -> set[str]:
    headings = re.findall(r"^#+ (.*)$", FENCE.sub("", page.read_text(encoding="utf-8")), re.M)
    return {re.sub(r"[^\w\- ]", "", h.strip().lower()).replace(" ", "-") for h in headings}


def pages() -> list[tuple[str, str]]:
    """Return the name and the text of every page, without fenced blocks."""
    found = [(str(page), FENCE.sub("", (ROOT / page).read_text("utf-8"))) for page in files((".md",))]
    assert len(found) > 250
    return found


def test_links_lead_somewhere() -> None:
    broken = []
    for page, text in pages():
        for target in LINK.findall(text):
            if "://" in target or target.startswith("mailto:"):
                continue
            name, _, anchor = target.partition("#")
            file = ((ROOT / page).parent / name).resolve() if name else ROOT / page
            if not file.exists() or (anchor and file.suffix == ".md" and anchor not in anchors(file)):
                broken.append(f"{page}: {target}")
    assert not broken, "links that lead nowhere"


def test_a_link_says_where_it_leads_not_which_file_that_is() -> None:
    named = {page: wrong for page, text in pages() if (wrong := FILE_AS_TEXT.findall(text))}
    assert named == {}


def test_every_document_is_reachable_from_the_readme() -> None:
    reached = {ROOT / "README.md"}
    waiting = list(reached)
    while waiting:
        page = waiting.pop()
        for target in LINK.findall(page.read_text(encoding="utf-8")):
            file = (page.parent / target.partition("#")[0]).resolve()
            if file.suffix == ".md" and file.exists() and file not in reached:
                reached.add(file)
                waiting.append(file)
    unreached = [str(p.relative_to(ROOT)) for p in (ROOT / "docs").rglob("*.md") if p not in reached]
    assert not unreached, f"no link leads from the README to {unreached}"
