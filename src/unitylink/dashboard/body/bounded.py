# SPDX-License-Identifier: BSD-3-Clause
"""Reads a file of a stranger, which may be of any size."""

from __future__ import annotations

from pathlib import Path

from unitylink.errors import UnityLinkError


def read_bounded(path: Path, most_bytes: int, remedy: str) -> bytes:
    """Return what a file has. Raises UnityLinkError if it cannot be read, or has more bytes than it may."""
    try:
        with open(path, "rb") as file:
            data = file.read(most_bytes + 1)
    except (OSError, ValueError) as error:  # a name with a NUL raises ValueError
        raise UnityLinkError(f"{path}: {getattr(error, 'strerror', None) or error}") from error
    if len(data) > most_bytes:
        raise UnityLinkError(f"{path}: has more than {most_bytes / 1e6:g} MB; {remedy}")
    return data
