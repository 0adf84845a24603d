# SPDX-License-Identifier: BSD-3-Clause
"""The log of a server: one line of JSON for each login, lease, write of a person, refusal, lost board."""

from __future__ import annotations

import contextlib
import datetime
import json
import sys
from collections.abc import Callable

from unitylink.line_writer import LineWriter

MOST = 10_000  # lines that wait for a slow disk or terminal
_LAST_S = 1.0  # how long the end waits for them

EVENTS = (
    *("login", "logout", "refused"),  # who comes and goes
    *("lease", "release", "asked", "lost", "safe"),  # who may write
    *("write", "stop", "arm", "record", "acknowledge"),  # what people do
    *("up", "away"),  # the board
)


class Audit:
    """Writes lines to `put`, for example a file's `write`. Texts from outside cannot begin a line.

    What `put` cannot write, because the disk is full for example, is counted in `unwritten`. The board and
    its users come before the log, so nothing ends because of that. It is said on stderr once, until a line
    can be written again.

    With `apart`, a `LineWriter` writes, until `close`. So nobody waits for a disk or a terminal that hangs,
    and a stop least of all. If MOST lines wait, the oldest is left out, and is one of `unwritten`.

    >>> Audit(print).line("login", 0.0, user="ana", where="127.0.0.1:4000")
    {"time": "1970-01-01T00:00:00.000Z", "event": "login", "user": "ana", "where": "127.0.0.1:4000"}
    """

    def __init__(self, put: Callable[[str], object], *, apart: bool = False) -> None:
        self._put = put
        self._failed = 0
        self._failing = False
        self._writer = LineWriter(self._write, most=MOST, tell_left_out=_tell_left_out) if apart else None

    @property
    def unwritten(self) -> int:
        """How many lines are not in the log."""
        return self._failed + (self._writer.left_out if self._writer else 0)

    def close(self) -> None:
        """Write the lines that wait, if that takes no longer than 1 s."""
        if self._writer is not None:
            self._writer.close(_LAST_S)

    def line(self, event: str, now_s: float, **facts: object) -> None:
        """Write one event. `now_s` is in s since 1970. Facts that are None are left out."""
        if event not in EVENTS:
            raise ValueError(f"{event!r} is no event of the audit log: {', '.join(EVENTS)}")
        moment = datetime.datetime.fromtimestamp(now_s, datetime.timezone.utc)
        entry: dict[str, object] = {
            "time": moment.strftime("%Y-%m-%dT%H:%M:%S.") + f"{moment.microsecond // 1000:03d}Z",
            "event": event,
            **{name: fact for name, fact in facts.items() if fact is not None},
        }
        text = json.dumps(entry, ensure_ascii=True, default=str)
        if self._writer is None:
            self._write(text)
        else:
            self._writer.write(text)

    def _write(self, text: str) -> None:
        try:
            self._put(text)
        except (OSError, ValueError) as error:  # ValueError: the end has closed it
            why = getattr(error, "strerror", None) or error
            self._failed += 1
            if not self._failing:
                complain(f"a line of the log cannot be written: {why}; lines are lost")
            self._failing = True
        else:
            self._failing = False


def _tell_left_out(count: int) -> None:
    complain(f"{count} older lines of the log are left out: what it is written to was too slow")


def complain(text: str) -> None:
    """Warn on stderr, if that can be written."""
    with contextlib.suppress(OSError, ValueError):
        print(f"warning: {text}", file=sys.stderr, flush=True)
