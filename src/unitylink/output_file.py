# SPDX-License-Identifier: BSD-3-Clause
"""Files that a program makes for a user. An existing file is overwritten only on request.

The native core has the same rule for `trace=` (`native/src/layer0_driver/capture.cpp`).
"""

from __future__ import annotations

import os
import stat
import tempfile
from pathlib import Path

from unitylink.errors import UnityLinkError


def check_output(path: str | Path, *, force: bool = False) -> None:
    """Raise the UnityLinkError of `create_output` if something is already there. Make nothing.

    This is for commands that first measure and then write.
    """
    try:
        there = os.lstat(path)
    except (OSError, ValueError):
        return  # only the attempt shows whether the file can be made
    if stat.S_ISLNK(there.st_mode):
        try:
            aim = os.stat(path)
        except OSError:
            aim = None
        if aim is None or not _a_stream(aim):
            raise UnityLinkError(
                f"{path}: this is a symbolic link, and is not written to; name the file itself"
            )
    elif stat.S_ISDIR(there.st_mode):
        raise UnityLinkError(f"{path}: this is a folder; name a file in it")
    elif stat.S_ISREG(there.st_mode) and not force:
        raise UnityLinkError(
            f"{path}: this file exists already; name another one, or add --force to replace it"
        )


def create_output(path: str | Path, *, force: bool = False) -> int:
    """Make a file and return its descriptor, for writing. An existing pipe or device is opened.

    An existing file is replaced only with `force`, and a symbolic link is not followed. Otherwise it raises
    UnityLinkError. So does a place where no file can be made.

    >>> import tempfile
    >>> path = tempfile.mkdtemp() + "/arm.csv"
    >>> os.close(create_output(path))
    >>> create_output(path)  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    unitylink.errors.UnityLinkError: ...arm.csv: this file exists already; name another ...
    """
    check_output(path, force=force)
    try:
        try:
            if _a_stream(os.stat(path)):
                return os.open(path, os.O_WRONLY | os.O_CLOEXEC)
            os.unlink(path)  # a regular file, with force
        except FileNotFoundError:
            pass
        return os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL | os.O_CLOEXEC, 0o666)
    except (OSError, ValueError) as error:
        raise UnityLinkError(f"{path}: {getattr(error, 'strerror', None) or error}") from error


def write_output(path: str | Path, data: bytes, *, force: bool = False) -> None:
    """Write a file in one piece, by the rules of `create_output`. A failure leaves no file behind."""
    descriptor = create_output(path, force=force)
    try:
        with open(descriptor, "wb") as stream:
            stream.write(data)
    except OSError as error:
        if stat.S_ISREG(os.lstat(path).st_mode):
            os.unlink(path)
        raise UnityLinkError(f"{path}: {error.strerror or error}") from error


def replace_file(path: str | Path, data: str | bytes) -> None:
    """Write a file. A reader finds either the old one or the new one whole, also after a crash.

    An existing file keeps its permissions, and a symbolic link stays one. Raises OSError.

    >>> import tempfile
    >>> path = Path(tempfile.mkdtemp()) / "arm.ul"
    >>> replace_file(path, "public arm() {}")
    >>> path.read_text()
    'public arm() {}'
    """
    path = Path(path).resolve()
    descriptor, beside = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
    try:
        with open(descriptor, "wb") as stream:
            stream.write(data.encode() if isinstance(data, str) else data)
        os.chmod(beside, _permissions(path))  # mkstemp makes private files
        os.replace(beside, path)
    except BaseException:
        os.unlink(beside)
        raise


def _permissions(path: Path) -> int:
    try:
        return stat.S_IMODE(path.stat().st_mode)
    except FileNotFoundError:
        mask = os.umask(0)
        os.umask(mask)
        return 0o666 & ~mask


def _a_stream(there: os.stat_result) -> bool:
    """Return whether it is a stream that keeps nothing: a pipe, a terminal, /dev/null."""
    return stat.S_ISFIFO(there.st_mode) or stat.S_ISCHR(there.st_mode) or stat.S_ISSOCK(there.st_mode)
