# SPDX-License-Identifier: BSD-3-Clause
"""A cache of compiled gateware. The key is a hash of its sources."""

from __future__ import annotations

import fcntl
import hashlib
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from unitylink.errors import ToolError
from unitylink.resources import cache_folder

KEPT = 64  # models of 1 to 5 MB each; the least recently used ones are removed


def cached(
    key: str,
    build: Callable[[Path], None],
    say: Callable[[str], None] = lambda text: None,
    *,
    kind: str = "rtl",
    suffix: str = ".so",
) -> Path:
    """Return the file for `key`. If there is none, or it is damaged, `build(path)` makes it.

    Each `kind` of file has a folder of its own. Other programs that want to build the same file wait
    meanwhile. Then they find it. A file's name contains its checksum. So a cut or changed file is noticed
    before it is loaded. Raises ToolError if the folder cannot be written.
    """
    folder = cache_folder(kind)
    try:
        if (kept := _find(folder, key, suffix)) is not None:
            return kept
        folder.mkdir(parents=True, exist_ok=True)
        with _locked(folder / "lock", say):
            if (kept := _find(folder, key, suffix)) is not None:
                return kept
            fresh = folder / f".{key}.{os.getpid()}"
            try:
                build(fresh)
                kept = folder / f"{key}-{_checksum(fresh)}{suffix}"
                os.replace(fresh, kept)
            finally:
                fresh.unlink(missing_ok=True)
            _trim(folder, suffix)
            return kept
    except OSError as error:
        raise ToolError(
            f"the cache of compiled gateware, {error.filename or folder}: {error.strerror}; XDG_CACHE_HOME "
            "can name a folder elsewhere"
        ) from error


def _find(folder: Path, key: str, suffix: str) -> Path | None:
    for path in folder.glob(f"{key}-*{suffix}"):
        if path.stem == f"{key}-{_checksum(path)}":
            with suppress(OSError):  # it belongs to another user, or was just removed
                os.utime(path)
            return path
        path.unlink(missing_ok=True)
    return None


def _checksum(path: Path) -> str:
    try:
        return hashlib.sha256(path.read_bytes()).hexdigest()[:16]
    except FileNotFoundError:  # another program has just removed it
        return ""


@contextmanager
def _locked(path: Path, say: Callable[[str], None]) -> Iterator[None]:
    with path.open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say("waiting for another program that compiles gateware")
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _trim(folder: Path, suffix: str) -> None:
    by_use = sorted(folder.glob(f"*{suffix}"), key=lambda path: path.stat().st_mtime, reverse=True)
    for path in by_use[KEPT:]:
        path.unlink(missing_ok=True)
