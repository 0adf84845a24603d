# SPDX-License-Identifier: BSD-3-Clause
"""How a program of this project ends: no error, no Ctrl-C and no closed pipe leaves as a traceback."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from typing import NoReturn

from unitylink.errors import UnityLinkError

INTERRUPTED = 130  # the exit codes that shells give to programs ended by SIGINT and SIGPIPE
PIPE_CLOSED = 141


def run_program(main: Callable[[], int], *, name: str) -> NoReturn:
    """Run `main` and exit with what it returns.

    An error of ours, or of a file, is one line on stderr that begins with `name`, and exit code 1; Ctrl-C is
    130, and a reader of stdout that went away (`run.py | head`) 141.

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
    """Keep the interpreter's own flush at exit from failing on the same pipe again."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def _complain(name: str, message: str) -> int:
    print(f"{name}: {message}", file=sys.stderr)
    return 1
