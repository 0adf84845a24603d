# SPDX-License-Identifier: BSD-3-Clause
"""The folder in which a design is built."""

from __future__ import annotations

from pathlib import Path

from unitylink.errors import BoardError


def make_folder(folder: Path) -> None:
    """Make the folder, or take an existing one. Raises BoardError if a symbolic link in it leads elsewhere.

    The folder itself may be a link. The programs that build there follow links, so there must be none in
    their way.
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
