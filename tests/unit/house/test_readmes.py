# SPDX-License-Identifier: BSD-3-Clause
"""The README.md of a folder names each of its files, and no file that does not exist."""

from __future__ import annotations

import re
from collections import defaultdict
from fnmatch import fnmatch
from functools import cache
from pathlib import PurePosixPath

from unit.house.files import files, text

FOLDERS = ("bench", "native", "protocol", "src", "tests", "tools")
# Tests and golden files are named after their subject. An __init__.py is described by its folder.
SELF_EVIDENT = ("__init__.py", "conftest.py", "py.typed", "README.md")
NAMED_AFTER = (("tests/", "test_*.py"), ("tests/golden/", "*"))
SOURCE = re.compile(r"[\w.]+\.(?:py|pyi|[ch]pp|[ch]|sh|ul|vhd|jinja|toml)|\w+/")


def words(page: PurePosixPath) -> set[str]:
    """Return the words that a page has in code type."""
    code = re.findall(r"`([^`\n]+)`", text(page))
    return {word for part in code for word in re.split(r"[\s,]+", part)}


def names(word: str, entry: str) -> bool:
    word = word.rstrip("/")
    stem = entry.partition(".")[0]
    if "*" not in word:
        return word in (entry, stem)
    return word.strip("*") != "" and (fnmatch(entry, word) or fnmatch(stem, word))


def pages() -> list[PurePosixPath]:
    found = [file for file in files() if file.name == "README.md" and file.parts[0] in FOLDERS]
    assert len(found) > 80
    return found


@cache
def folders() -> dict[PurePosixPath, set[str]]:
    """Return the names of the files and folders in each folder."""
    entries = defaultdict(set)
    for file in files():
        for inner, folder in zip((file, *file.parents), file.parents, strict=False):
            entries[folder].add(inner.name)
    return entries


def unnamed(page: PurePosixPath) -> list[str]:
    """Return the entries of the page's folder that it does not name."""
    entries = folders()[page.parent]
    told = words(page)
    return [
        entry
        for entry in sorted(entries.difference(SELF_EVIDENT))
        if not any(names(word, entry) for word in told)
        and not any(str(page).startswith(place) and fnmatch(entry, kind) for place, kind in NAMED_AFTER)
    ]


def test_every_file_is_named() -> None:
    missing = {str(page): entries for page in pages() if (entries := unnamed(page))}
    assert missing == {}, "a page says nothing of these"


def test_every_named_file_is_there() -> None:
    every = {part for file in files() for part in file.parts}
    gone = {}
    for page in pages():
        named = {word for word in words(page) if SOURCE.fullmatch(word) and not re.search("[A-Z]{4}", word)}
        if wrong := {word.rstrip("/") for word in named} - every:
            gone[str(page)] = sorted(wrong)
    assert gone == {}, "a page names these, and they are not there"
