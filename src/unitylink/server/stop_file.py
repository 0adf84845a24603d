# SPDX-License-Identifier: BSD-3-Clause
"""A file that says who has stopped a robot, so that a stop outlives the program that took it."""

from __future__ import annotations

import contextlib
import os
from pathlib import Path

from unitylink.errors import UnityLinkError

SOMEBODY = "somebody"  # if the file does not say who
_MOST = 64  # characters of a name


class StopFile:
    """While the file exists, the robot is stopped. It has the name of who has stopped it.

    `option` of the command line has named it. Raises UnityLinkError if no file can be written there.
    """

    def __init__(self, path: str, option: str = "--stop-file") -> None:
        self.path, self._option = Path(path), option
        folder = self.path.parent
        if not folder.is_dir() or not os.access(folder, os.W_OK | os.X_OK):
            raise UnityLinkError(f"{option} {path}: {folder} is no folder where this program may write")
        if self.path.is_dir():
            raise UnityLinkError(f"{option} {path}: this is a folder; name a file in it")
        if self.path.exists() and not self.path.is_file():  # who reads a pipe waits for its other end
            raise UnityLinkError(f"{option} {path}: this is a device or a pipe; name a file")

    def read(self) -> str:
        """Return who has stopped the robot, or "" if nobody has.

        A file that cannot be read is there, so somebody has.
        """
        try:
            text = self.path.read_bytes()[: 4 * _MOST].decode("utf-8", "replace")
        except FileNotFoundError:
            return ""
        except OSError:
            return SOMEBODY
        name = text.split("\n", 1)[0].strip()[:_MOST]
        return name if name and name.isprintable() else SOMEBODY

    def write(self, who: str) -> None:
        """Say that somebody has stopped the robot. It is on the disk when this returns. Raises OSError."""
        new = self.path.with_name(f".{self.path.name}.new")
        with open(new, "w", encoding="utf-8") as file:
            file.write(f"{who}\n")
            file.flush()
            os.fsync(file.fileno())
        os.replace(new, self.path)
        _keep_names(self.path.parent)

    def remove(self) -> None:
        """Say that the robot was armed. Raises OSError, and then the robot counts as stopped."""
        with contextlib.suppress(FileNotFoundError):
            self.path.unlink()
            _keep_names(self.path.parent)


def _keep_names(folder: Path) -> None:
    """Write the names of a folder to the disk, where the system can."""
    with contextlib.suppress(OSError):
        one = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(one)
        finally:
            os.close(one)
