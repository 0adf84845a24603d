# SPDX-License-Identifier: BSD-3-Clause
"""The log of a server: one line of JSON for each login, lease, write of a person, refusal, lost board."""

from __future__ import annotations

import contextlib
import datetime
import json
import sys
from collections.abc import Callable

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

    >>> Audit(print).line("login", 0.0, user="ana", where="127.0.0.1:4000")
    {"time": "1970-01-01T00:00:00.000Z", "event": "login", "user": "ana", "where": "127.0.0.1:4000"}
    """

    def __init__(self, put: Callable[[str], object]) -> None:
        self._put = put
        self.unwritten = 0
        self._failing = False

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
        try:
            self._put(json.dumps(entry, ensure_ascii=True, default=str))
        except OSError as error:
            self.unwritten += 1
            if not self._failing:
                complain(f"a line of the log cannot be written: {error.strerror or error}; lines are lost")
            self._failing = True
        else:
            self._failing = False


def complain(text: str) -> None:
    """Warn on stderr, if that can be written."""
    with contextlib.suppress(OSError, ValueError):
        print(f"warning: {text}", file=sys.stderr, flush=True)
