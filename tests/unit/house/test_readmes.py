# SPDX-License-Identifier: BSD-3-Clause
"""The README.md of a folder names each of its files, and no file that is not there."""

from __future__ import annotations

import re
import subprocess
from fnmatch import fnmatch
from pathlib import Path, PurePosixPath

import pytest

ROOT = Path(__file__).resolve().parents[3]
COMMAND = ["git", "-c", "safe.directory=*", "ls-files", "--cached", "--others", "--exclude-standard"]
FILES = [
    PurePosixPath(name)
    for name in subprocess.run(
        COMMAND, cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.splitlines()
    if (ROOT / name).is_file()
]
EVERY = {part for file in FILES for part in file.parts}
FOLDERS = ("bench", "native", "protocol", "src", "tests", "tools")
PAGES = [file for file in FILES if file.name == "README.md" and file.parts[0] in FOLDERS]
# Tests and goldens are named after what they are of; an __init__.py is what its folder is.
SELF_EVIDENT = ("__init__.py", "conftest.py", "py.typed", "README.md")
NAMED_AFTER = (("tests/", "test_*.py"), ("tests/golden/", "*"))
SOURCE = re.compile(r"[\w.]+\.(?:py|pyi|[ch]pp|[ch]|sh|ul|vhd|jinja|toml)|\w+/")


def words(page: PurePosixPath) -> set[str]:
    """Return what a page has in code type, word by word."""
    code = re.findall(r"`([^`\n]+)`", (ROOT / page).read_text("utf-8"))
    return {word for part in code for word in re.split(r"[\s,]+", part)}


def names(word: str, entry: str) -> bool:
    word = word.rstrip("/")
    stem = entry.partition(".")[0]
    return word.strip("*") != "" and (fnmatch(entry, word) or fnmatch(stem, word))


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_every_file_is_named(page: PurePosixPath) -> None:
    folder = page.parent
    entries = {file.relative_to(folder).parts[0] for file in FILES if file.is_relative_to(folder)}
    told = words(page)
    missing = [
        entry
        for entry in sorted(entries.difference(SELF_EVIDENT))
        if not any(names(word, entry) for word in told)
        and not any(str(page).startswith(place) and fnmatch(entry, kind) for place, kind in NAMED_AFTER)
    ]
    assert not missing, f"{page} says nothing of {missing}"


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_every_named_file_is_there(page: PurePosixPath) -> None:
    named = {word for word in words(page) if SOURCE.fullmatch(word) and not re.search("[A-Z]{4}", word)}
    assert {word.rstrip("/") for word in named} <= EVERY, page
