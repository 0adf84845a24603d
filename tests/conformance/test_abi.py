# SPDX-License-Identifier: BSD-3-Clause
"""A program that was built with the last release can use this library."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))
import abi  # noqa: E402


def released() -> str:
    return abi.RELEASED.read_text("utf-8")


def edited(pattern: str, replacement: str) -> str:
    text, edits = re.subn(pattern, replacement, released(), flags=re.S)
    assert edits, pattern
    return text


def struct(name: str, pattern: str, replacement: str | Callable[[re.Match[str]], str]) -> str:
    """The ABI of the release with an edit in one struct."""
    inside = re.search(rf"<class-decl name='{name}'.*?</class-decl>", released(), re.S)
    assert inside is not None
    text, edits = re.subn(pattern, replacement, inside[0], flags=re.S)
    assert edits, pattern
    return released().replace(inside[0], text)


NEW = r"\s*<elf-symbol name='ul_version'[^\n]*|\s*<function-decl name='ul_version'.*?</function-decl>"
LAST = r"\s*<data-member [^\n]*\n[^\n]*\n\s*</data-member>(\s*</class-decl>)"
TYPE = r"(name='attempts' type-id=)'[^']*'"
CLOSE = r"(<function-decl name='ul_close'.*?<parameter type-id=')[^']*"
SWAP = {"128": "'160'", "160": "'128'"}
EDITS = {  # as if the release had been this, and the new version what the release is; and what is told
    "new members": (
        struct("ul_statistics", rf"size-in-bits='\d+'(.*){LAST}", r"size-in-bits='1408'\1\2"),
        "",
    ),
    "new function": (edited(NEW, ""), ""),
    "no size": (struct("ul_exchange_word", rf"-bits='64'(.*?){LAST}", r"-bits='32'\1\2"), "type size"),
    "other place": (struct("ul_error", "'(128|160)'", lambda at: SWAP[at[1]]), "offset"),
    "other type": (struct("ul_error", TYPE, r"\1'type-id-11'"), "attempts"),
    "other name": (struct("ul_error", "'attempts'", "'tries'"), "'ul_error::tries' changed"),
    "function gone": (edited("ul_alive", "ul_lives"), "ul_lives"),
    "other argument": (edited(CLOSE, r"\1type-id-6"), "ul_close"),
}


@pytest.mark.parametrize("name", EDITS)
def test_what_may_change(name: str) -> None:
    old, told = EDITS[name]
    difference = abi.difference(old, released())
    assert told in difference and bool(told) == bool(difference)


def test_a_comparison_that_breaks_off_is_no_pass(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    (tmp_path / "abidiff").write_text("#!/bin/sh\nkill -9 $$\n", encoding="utf-8")
    (tmp_path / "abidiff").chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}:{os.environ['PATH']}")
    assert "ends with -9" in abi.difference(released(), released())


def test_this_library_serves_programs_of_the_last_release() -> None:
    command = [sys.executable, str(ROOT / "tools" / "abi.py")]
    done = subprocess.run(command, check=False, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
