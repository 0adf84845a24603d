# SPDX-License-Identifier: BSD-3-Clause
"""The folder of recordings: what is in it, and how much more may come into it."""

from __future__ import annotations

import os
import re
import shutil
import stat
import time
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from unitylink.errors import UnityLinkError, UnknownName, shown
from unitylink.recording import ENDINGS

FOLDER = "recordings"
MOST_BYTES = 1_000_000_000  # of all recordings together
FREE_BYTES = 200_000_000  # of the disk, which stay free for others
_NAME = re.compile(r"[A-Za-z0-9_][\w.-]{0,200}", re.ASCII)


@dataclass(frozen=True)
class Kept:
    """A recording in the folder. `changed_s` is in s since 1970."""

    name: str
    size_bytes: int
    changed_s: float

    def told(self) -> dict[str, Any]:
        """Return it for JSON."""
        return asdict(self)


class Shelf:
    """Recordings in one folder, which is made when the first one begins.

    Names come from outside. A name is looked up among those of the files that are there, and is never made
    into a path before. So no name leads out of the folder, and neither does a symbolic link.
    """

    def __init__(self, folder: str | Path = FOLDER, most_bytes: int = MOST_BYTES) -> None:
        self.folder = Path(folder)
        self.most_bytes = most_bytes

    def all(self) -> list[Kept]:
        """Return the recordings, the newest first."""
        return sorted(self._entries(), key=lambda one: (-one.changed_s, one.name))

    def _entries(self) -> Iterator[Kept]:
        try:
            with os.scandir(self.folder) as entries:
                for entry in entries:
                    if not _NAME.fullmatch(entry.name) or Path(entry.name).suffix.lower() not in ENDINGS:
                        continue
                    try:
                        found = entry.stat(follow_symlinks=False)
                    except FileNotFoundError:  # somebody has removed it at this moment
                        continue
                    if stat.S_ISREG(found.st_mode):
                        yield Kept(entry.name, found.st_size, found.st_mtime)
        except FileNotFoundError:
            return
        except OSError as error:
            raise UnityLinkError(f"{self.folder}: {error.strerror or error}") from error

    def find(self, name: str) -> Path:
        """Return the path of a recording. Raises UnknownName if the folder has none of this name."""
        if not any(one.name == name for one in self._entries()):
            raise UnknownName(f"there is no recording {shown(name)}")
        return self.folder / name

    def new(self, robot: str, ending: str) -> Path:
        """Return a path for a new recording, which no file has: `arm-20260131-120000.mcap`.

        Makes the folder. Raises UnityLinkError if there is no room, or no such folder can be made.
        """
        try:
            self.folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise UnityLinkError(
                f"{self.folder}: {error.strerror or error}; choose another folder with --recordings"
            ) from error
        if reason := self.full():
            raise UnityLinkError(reason)
        stem = f"{robot}-{time.strftime('%Y%m%d-%H%M%S')}"
        taken = set(os.listdir(self.folder))
        count, name = 1, f"{stem}{ending}"
        while name in taken:
            count += 1
            name = f"{stem}-{count}{ending}"
        return self.folder / name

    def full(self) -> str:
        """Return why nothing more may be written, or ""."""
        used = sum(one.size_bytes for one in self._entries())
        if used >= self.most_bytes:
            return (
                f"the recordings have {used / 1e6:,.0f} MB, and may have {self.most_bytes / 1e6:,.0f} MB; "
                "delete some, or start with a greater --recordings-mb"
            )
        free = shutil.disk_usage(self.folder).free
        if free < FREE_BYTES:
            return f"the disk of the recordings has only {free / 1e6:,.0f} MB left"
        return ""

    def remove(self, name: str) -> None:
        """Delete a recording. Raises UnknownName if the folder has none of this name."""
        path = self.find(name)
        try:
            path.unlink()
        except OSError as error:
            raise UnityLinkError(f"{name}: {error.strerror or error}") from error
