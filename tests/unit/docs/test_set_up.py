# SPDX-License-Identifier: BSD-3-Clause
"""A page that has its reader run pytest says what brings it: neither `make demo` nor `make build` does."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[3]
TRACKED = ["git", "-c", "safe.directory=*", "ls-files", "*.md"]
PAGES = subprocess.run(TRACKED, cwd=ROOT, capture_output=True, text=True, check=True).stdout.split()
COMMAND = re.compile(r"^(?:\$ )?python -m pytest|\.venv/bin/python -m pytest", re.M)
ORIGIN = re.compile(r"make (?:develop|extras)|pip install [^\n]*pytest")
ABOVE = ("tests/golden/", "tests/unit/")  # tests/README.md says it for these


def asks(page: str) -> bool:
    return COMMAND.search((ROOT / page).read_text("utf-8")) is not None and not page.startswith(ABOVE)


@pytest.mark.parametrize("page", [page for page in PAGES if asks(page)])
def test_a_page_that_runs_pytest_says_what_brings_it(page: str) -> None:
    assert ORIGIN.search((ROOT / page).read_text("utf-8")), f"{page}: make develop, or make extras"


def test_the_pages_for_users_and_for_contributors_are_among_them() -> None:
    asking = {page for page in PAGES if asks(page)}
    assert {"CONTRIBUTING.md", "tests/README.md", "docs/start.md", "docs/first-hour.md"} <= asking
