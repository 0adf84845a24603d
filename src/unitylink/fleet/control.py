# SPDX-License-Identifier: BSD-3-Clause
"""How `unitylink fleet update` asks the program that runs the fleet: by a socket of the same user."""

from __future__ import annotations

import contextlib
import hashlib
import json
import logging
import os
import socket
import stat
import tempfile
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from unitylink.errors import LinkNotFound, UnityLinkError

_log = logging.getLogger("unitylink.fleet")
_LINE_MOST = 65536
_PATH_MOST = 100  # bytes; a system takes 103 to 107 for a socket
_ASK_S = 2.0  # how long a client has to say what it wants
Say = Callable[[str, str], None]
Do = Callable[[dict[str, Any], Say], bool]


def socket_path(file: Path) -> Path:
    """Return where the program that runs the fleet of a file listens.

    Raises UnityLinkError if other users could be there.
    """
    name = f"fleet-{hashlib.sha256(str(file.resolve()).encode()).hexdigest()[:16]}.sock"
    base = os.environ.get("XDG_RUNTIME_DIR", "")
    folder = Path(base, "unitylink")
    if not base or len(os.fsencode(folder / name)) > _PATH_MOST:
        folder = Path(tempfile.gettempdir(), f"unitylink-{os.getuid()}")
    if len(os.fsencode(folder / name)) > _PATH_MOST:
        raise UnityLinkError(f"{folder} is too long for a socket; set XDG_RUNTIME_DIR to a shorter folder")
    folder.mkdir(mode=0o700, parents=True, exist_ok=True)
    about = folder.lstat()
    if not stat.S_ISDIR(about.st_mode) or about.st_uid != os.getuid() or about.st_mode & 0o077:
        raise UnityLinkError(f"{folder} is open to other users; remove it, or run chmod go= {folder}")
    return folder / name


class Control:
    """Takes one wish at a time, and does it with `do`, whose words go back to whoever asked."""

    def __init__(self, file: Path, do: Do) -> None:
        self._path, self._do = socket_path(file), do
        self._path.unlink(missing_ok=True)  # of a program that was killed; Zenoh says that no other one runs
        self._door = socket.socket(socket.AF_UNIX)
        self._door.bind(str(self._path))
        self._door.listen()
        self._thread = threading.Thread(target=self._serve, name="fleet control", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Take no more. A wish that is being done goes on until the program ends."""
        with contextlib.suppress(OSError):
            self._door.shutdown(socket.SHUT_RDWR)
        self._door.close()
        self._path.unlink(missing_ok=True)

    def _serve(self) -> None:
        while True:
            try:
                talk, _ = self._door.accept()
            except OSError:
                return
            with talk, contextlib.suppress(OSError, ValueError, RecursionError):
                talk.settimeout(_ASK_S)
                wish = json.loads(talk.makefile("r", encoding="utf-8").readline(_LINE_MOST))
                talk.settimeout(None)
                if isinstance(wish, dict):
                    self._answer(talk, wish)

    def _answer(self, talk: socket.socket, wish: dict[str, Any]) -> None:
        def send(told: dict[str, Any]) -> None:
            with contextlib.suppress(OSError):  # whoever asked is gone; what was begun is done all the same
                talk.sendall(json.dumps(told).encode() + b"\n")

        try:
            done = self._do(wish, lambda robot, text: send({"robot": robot, "text": text}))
        except UnityLinkError as error:
            send({"error": str(error)})
        except Exception as error:  # the next wish may be a better one
            _log.exception("what was asked for was not done")
            send({"error": f"{type(error).__name__}: {error}"})
        else:
            send({"done": done})


def ask(file: Path, wish: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Ask the program that runs the fleet of a file, and yield what it says.

    Raises LinkNotFound if none runs on this machine for this user.
    """
    with socket.socket(socket.AF_UNIX) as talk:
        try:
            talk.connect(str(socket_path(file)))
        except OSError:
            raise LinkNotFound(
                f"no program of this user runs the fleet of {file} on this machine: unitylink fleet {file}"
            ) from None
        talk.sendall(json.dumps(wish).encode() + b"\n")
        for line in talk.makefile("r", encoding="utf-8"):
            yield json.loads(line)
