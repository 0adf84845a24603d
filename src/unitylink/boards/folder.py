# SPDX-License-Identifier: BSD-3-Clause
"""The folder that a design is built in."""

from __future__ import annotations

from pathlib import Path

from unitylink.errors import BoardError


def make_folder(folder: Path) -> None:
    """Make the folder, or take one that is there: BoardError where a symbolic link in it leads elsewhere.

    The folder itself may be one. The programs that build there follow links, so none may wait for them.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        links = sorted(path for path in folder.iterdir() if path.is_symlink())
    except OSError as error:
        raise BoardError(f"{folder}: {error.strerror or error}") from error
    if links:
        raise BoardError(
            f"{links[0]} is a symbolic link to {links[0].readlink()} and was not followed; "
            "remove it or build elsewhere with --out"
        )
