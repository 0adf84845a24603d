# SPDX-License-Identifier: BSD-3-Clause
"""The files of this checkout: those in git, and new ones."""

from __future__ import annotations

import subprocess
from functools import cache
from pathlib import Path, PurePosixPath

ROOT = Path(__file__).resolve().parents[3]
# safe.directory is set, because in a container the checkout often belongs to another user
COMMAND = ["git", "-c", "safe.directory=*", "ls-files", "--cached", "--others", "--exclude-standard"]


@cache
def files(suffixes: tuple[str, ...] = ()) -> list[PurePosixPath]:
    """Return the files with one of these suffixes, below the root. Without a suffix, all files count."""
    if suffixes:
        return [file for file in files() if file.suffix in suffixes]
    listed = subprocess.run(COMMAND, cwd=ROOT, capture_output=True, text=True, check=True).stdout
    return [PurePosixPath(name) for name in listed.splitlines() if (ROOT / name).is_file()]


def text(file: PurePosixPath | str) -> str:
    """Return the text of a file of the checkout."""
    return (ROOT / file).read_text("utf-8")
