# SPDX-License-Identifier: BSD-3-Clause
"""A page that asks its reader to run pytest says how to install it.

Neither `make demo` nor `make build` does.
"""

from __future__ import annotations

import re

from unit.house.files import files, text

COMMAND = re.compile(r"^(?:\$ )?python -m pytest|\.venv/bin/python -m pytest", re.M)
ORIGIN = re.compile(r"make (?:develop|extras)|pip install [^\n]*pytest")
ABOVE = ("tests/golden/", "tests/unit/")  # tests/README.md says it for these


def asking() -> set[str]:
    """Return the pages that ask their reader to run pytest."""
    pages = {str(page) for page in files((".md",)) if COMMAND.search(text(page))}
    return {page for page in pages if not page.startswith(ABOVE)}


def test_a_page_that_runs_pytest_says_what_brings_it() -> None:
    assert {page for page in asking() if not ORIGIN.search(text(page))} == set(), (
        "make develop, or make extras"
    )


def test_the_pages_for_users_and_for_contributors_are_among_them() -> None:
    assert {"CONTRIBUTING.md", "tests/README.md", "docs/start.md", "docs/first-hour.md"} <= asking()
