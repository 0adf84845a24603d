# SPDX-License-Identifier: BSD-3-Clause
"""Files that a server writes: a log that lines are added to, and whether a file can be written at all."""

from __future__ import annotations

import errno
import os

from unitylink.errors import UnityLinkError


class LogFile:
    """Adds lines to a file, which may be there. Raises UnityLinkError if it cannot be opened.

    `option` of the command line has named the file.
    """

    def __init__(self, path: str, option: str) -> None:
        check_writable(path, option)
        self._file = open(path, "ab", buffering=0)  # noqa: SIM115
        self._torn = False

    def put(self, line: str) -> None:
        """Add a line. Raises OSError if it is not there as a whole, for example because the disk is full."""
        data = line.encode() + b"\n"
        if self._torn:  # the line before is there in part
            data = b"\n" + data
        written = self._file.write(data)
        self._torn = written != len(data)
        if self._torn:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    def close(self) -> None:
        self._file.close()


def check_writable(path: str, option: str) -> None:
    """Raises UnityLinkError, with the option that names the file, if it cannot be written. Makes nothing."""
    folder = os.path.dirname(path) or "."
    if os.path.isdir(path):
        why = "it is a folder; name a file"
    elif not os.path.isdir(folder):
        why = f"there is no folder {folder}; make it first"
    elif not os.access(path if os.path.exists(path) else folder, os.W_OK):
        why = "this user may not write it; name another file"
    else:
        return
    raise UnityLinkError(f"{option} {path}: {why}")
