# SPDX-License-Identifier: BSD-3-Clause
"""The other processes of the bench: native programs, the twin, LiteX's client.

Lines on pipes control them.
"""

from __future__ import annotations

import fcntl
import json
import select
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from types import TracebackType

from unitylink.protocol import FRAME_CRC16_BYTES

from .figure import BenchError

PATIENCE_S = 60.0  # longest wait for one answer; every series is far shorter
_MADE_S = 600.0  # longest wait for what is made once: it may compile, or ask a package index
_END_S = 5.0  # longest wait for the end of a process
_LAST_LINES = 6  # number of lines of stderr that are kept
_LINE_CHARACTERS = 300


def find_checkout() -> Path:
    """Return the source checkout from which this library runs. An installed wheel has no bench programs."""
    for folder in (*Path(__file__).resolve().parents, Path.cwd()):
        if (folder / "bench" / "native").is_dir() and (folder / "CMakeLists.txt").is_file():
            return folder
    raise BenchError("the bench needs a source checkout (its programs are in bench/); run `make bench` there")


def native(checkout: Path, name: str) -> Path:
    """Return the path of a program of `bench/native/`."""
    path = checkout / "build" / "native" / name
    if not path.is_file():
        raise BenchError(f"{path.relative_to(checkout)} is not built; `make bench` builds it")
    return path


@contextmanager
def alone(folder: Path) -> Iterator[Path]:
    """Lock `folder`, so that no two runs make the same thing in it at the same time."""
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield folder


def made(command: Sequence[str | Path], environment: Mapping[str, str] | None = None) -> str:
    """Run a program that makes something, and wait until it ends. Return its output.

    Raises BenchError if it fails or does not end.
    """
    told = " ".join(map(str, command))
    try:
        done = subprocess.run(
            command, env=environment, capture_output=True, text=True, check=False, timeout=_MADE_S
        )
    except subprocess.TimeoutExpired:
        raise BenchError(f"`{told}` does not end; is what it asks for reachable?") from None
    if done.returncode:
        raise BenchError(f"`{told}` failed: {(done.stderr or done.stdout).strip()[-1000:]}")
    return done.stdout


def frame_bytes(payload: int) -> int:
    """Return the length in bytes of a frame with a payload shorter than 254 bytes: kind, COBS, check,
    delimiter.

    >>> frame_bytes(8)  # a post
    14
    """
    return payload + 2 + FRAME_CRC16_BYTES + 1


class Silence(BenchError):
    """A process gave no answer in time."""


class Process:
    """A process that answers each line with a line. It ends when its standard input is closed.

    >>> with Process(["cat"]) as cat:
    ...     cat.ask("1 2")
    '1 2'
    """

    def __init__(self, command: Sequence[str | Path], *, pass_fds: Sequence[int] = ()) -> None:
        self.name = Path(command[0]).name
        try:
            self._process = subprocess.Popen(
                [str(part) for part in command],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                text=True,
                pass_fds=tuple(pass_fds),
            )
        except OSError as error:
            raise BenchError(f"{self.name} did not start: {error}") from error
        self._said: deque[str] = deque(maxlen=_LAST_LINES)
        self._listener = threading.Thread(target=self._listen, daemon=True)
        self._listener.start()

    def _listen(self) -> None:
        """Keep the last lines of stderr.

        If nobody read them, the pipe would fill and the process would stop.
        """
        assert self._process.stderr is not None
        with self._process.stderr as stderr:
            while line := stderr.readline(_LINE_CHARACTERS):
                if line.strip():
                    self._said.append(line.rstrip())

    def line(self, patience_s: float = PATIENCE_S) -> str:
        """Return the next line that the process prints. Raises Silence if none comes within `patience_s`."""
        assert self._process.stdout is not None
        ready, _, _ = select.select([self._process.stdout], [], [], patience_s)
        if not ready:
            said = f"; on stderr: {self._stderr()}" if self._said else ""
            raise Silence(f"{self.name} said nothing for {patience_s:.0f} s{said}")
        text = self._process.stdout.readline()
        if not text:
            raise BenchError(f"{self.name} ended early: {self._last_words()}")
        return text.strip()

    def ask(self, text: str, patience_s: float = PATIENCE_S) -> str:
        """Send a line and return the answer."""
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(text + "\n")
            self._process.stdin.flush()
        except BrokenPipeError:
            raise BenchError(f"{self.name} ended early: {self._last_words()}") from None
        return self.line(patience_s)

    def series(self, text: str) -> list[int]:
        """Send a line and return the whole numbers of the answer."""
        return [int(word) for word in self.ask(text).split()]

    def close(self) -> None:
        """End the process and wait for it."""
        process = self._process
        for pipe in (process.stdin, process.stdout):
            if pipe is not None:
                with suppress(BrokenPipeError):  # the process has already ended, as wanted
                    pipe.close()
        try:
            process.wait(timeout=_END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        self._listener.join(_END_S)  # this takes long only if a child of the process also has the pipe

    def __enter__(self) -> Process:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _stderr(self) -> str:
        return "\n".join(self._said)

    def _last_words(self) -> str:
        try:
            code = self._process.wait(timeout=_END_S)
        except subprocess.TimeoutExpired:
            return self._stderr() or "it closed its output"
        self._listener.join(_END_S)
        return self._stderr() or f"exit code {code}"


def twin(endpoint: str, **configuration: int) -> Process:
    """Start the twin in a process of its own. Its first line of output is the URL to connect to.

    `configuration` are fields of `BoardConfiguration`. Addresses have 16 bits, as on a TosNet board.
    """
    options = {"address_bits": 16, **configuration}
    return Process([sys.executable, "-m", "unitylink_lab.bench.board", endpoint, json.dumps(options)])
