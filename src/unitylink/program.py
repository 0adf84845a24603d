# SPDX-License-Identifier: BSD-3-Clause
"""How a program of this project ends: after errors, signals and closed pipes, without a traceback."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import SimpleQueue
from typing import Any, NoReturn

from unitylink.errors import UnityLinkError

INTERRUPTED = 130  # the exit codes that shells give to programs ended by SIGINT and SIGPIPE
PIPE_CLOSED = 141


def run_program(main: Callable[[], int], *, name: str) -> NoReturn:
    """Run `main` and exit with the code that it returns.

    An error of ours, or of a file, becomes one line on stderr that begins with `name`. The exit code is then
    1. Ctrl-C gives 130. If the reader of stdout goes away (`run.py | head`), it is 141.

        if __name__ == "__main__":
            run_program(main, name="scara")
    """
    try:
        code = main()
        sys.stdout.flush()
    except UnityLinkError as error:
        code = _complain(name, str(error))
    except BrokenPipeError:
        silence_stdout()
        code = PIPE_CLOSED
    except OSError as error:
        code = _complain(name, f"{error.filename}: {error.strerror}" if error.filename else str(error))
    except KeyboardInterrupt:
        code = INTERRUPTED
    sys.exit(code)


def silence_stdout() -> None:
    """Prevent the interpreter's flush at exit from failing on the same pipe again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _complain(name: str, message: str) -> int:
    print(f"{name}: {message}", file=sys.stderr)
    return 1


@contextmanager
def ended_by_signals() -> Iterator[None]:
    """Let SIGTERM act like Ctrl-C, and in the background SIGINT too.

    So the program ends with its link closed.
    """
    with _heard_by(signal.default_int_handler):
        yield


@contextmanager
def stopped_by_signals() -> Iterator[threading.Event]:
    """Yield an event that SIGINT and SIGTERM set. These signals then do nothing else.

    A thread sets it. A handler that did so itself would wait for ever if it came while the main thread, which
    runs it, holds the lock of the event. That is so for a moment of each `wait`.
    """
    stop = threading.Event()
    signals: SimpleQueue[bool] = SimpleQueue()  # a handler may put something into it at any moment

    def follow() -> None:
        while signals.get():
            stop.set()

    thread = threading.Thread(target=follow, name="unitylink signals", daemon=True)
    thread.start()
    try:
        with _heard_by(lambda *_: signals.put(True)):
            yield stop
    finally:
        signals.put(False)
        thread.join()


@contextmanager
def _heard_by(handler: Callable[..., Any]) -> Iterator[None]:
    """Handlers belong to the process.

    At the end, the caller's own handlers are restored. It may be a program or a test.
    """
    before = {number: signal.signal(number, handler) for number in (signal.SIGINT, signal.SIGTERM)}
    try:
        yield
    finally:
        for number, one in before.items():
            signal.signal(number, one)
