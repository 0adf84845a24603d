# SPDX-License-Identifier: BSD-3-Clause
"""The real command line, run in processes of its own."""

from __future__ import annotations

import os
import pty
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
SCARA = ROOT / "examples" / "scara" / "scara.ul"
# There are no wheels of MuJoCo for an older Python.
MUJOCO = pytest.mark.skipif(sys.version_info < (3, 11), reason="MuJoCo wants Python 3.11")
UNITYLINK = Path(sys.executable).with_name("unitylink")
PATIENCE_S = 60  # how long a command may take on a loaded machine before the test calls it hung

Run = Callable[..., "subprocess.CompletedProcess[str]"]


@pytest.fixture
def run(tmp_path: Path) -> Run:
    """Run `unitylink ARGUMENTS` to its end in a temporary folder."""

    def unitylink(
        *arguments: object, text: str | None = None, **environment: str
    ) -> subprocess.CompletedProcess[str]:
        done = subprocess.run(
            [UNITYLINK, *map(str, arguments)],
            input=text,
            stdin=subprocess.DEVNULL if text is None else None,
            capture_output=True,
            encoding="utf-8",
            cwd=tmp_path,
            env={**os.environ, **environment},
            timeout=PATIENCE_S,
            check=False,
        )
        assert "Traceback" not in done.stderr, done.stderr
        return done

    return unitylink


@pytest.fixture
def on_terminal(tmp_path: Path) -> Callable[..., str]:
    """Run `unitylink ARGUMENTS` with a terminal as its stdout.

    Return what it shows, with the escape codes.
    """

    def unitylink(*arguments: object, **environment: str) -> str:
        controller, terminal = pty.openpty()
        settings = {k: v for k, v in os.environ.items() if k != "NO_COLOR"}
        settings |= {"TERM": "xterm-256color", "COLUMNS": "100", **environment}
        command = [str(UNITYLINK), *map(str, arguments)]
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=terminal, cwd=tmp_path, env=settings):
            os.close(terminal)
            shown = b""
            try:
                while data := os.read(controller, 65536):
                    shown += data
            except OSError:  # this is how Linux reports that the other side of a pty is closed
                pass
        os.close(controller)
        return shown.decode()

    return unitylink


@pytest.fixture
def scara(tmp_path: Path) -> Path:
    """A copy of the SCARA's spec in the temporary folder."""
    return Path(shutil.copy(SCARA, tmp_path / "scara.ul"))


@dataclass
class Server:
    """A running `unitylink simulate`."""

    process: subprocess.Popen[str]
    url: str
    banner: str

    @property
    def port(self) -> int:
        return int(self.url.rpartition(":")[2])

    def stop(self, how: signal.Signals = signal.SIGTERM) -> tuple[int, str]:
        """End it. Return its exit code and what it still printed on stderr."""
        self.process.send_signal(how)
        _, err = self.process.communicate(timeout=PATIENCE_S)
        return self.process.returncode, err


@pytest.fixture
def serve(tmp_path: Path) -> Iterator[Callable[..., Server]]:
    """Start `unitylink simulate ARGUMENTS` and wait until it serves. It ends with the test."""
    running: list[subprocess.Popen[str]] = []

    def start(*arguments: object) -> Server:
        process = subprocess.Popen(
            [UNITYLINK, "simulate", *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            encoding="utf-8",
            cwd=tmp_path,
        )
        running.append(process)
        assert process.stdout is not None and process.stderr is not None
        banner = process.stdout.readline()  # printed when it serves; empty at once if the command fails
        found = re.search(r"at (\S+:\S+)", banner)
        assert found, f"no URL in {banner!r}; stderr: {process.stderr.read() if not banner else ''}"
        return Server(process, found.group(1), banner)

    yield start
    for process in running:
        if process.poll() is None:
            process.kill()
        process.communicate()
