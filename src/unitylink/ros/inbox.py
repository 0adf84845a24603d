# SPDX-License-Identifier: BSD-3-Clause
"""From topics to the gateware: what was asked last is written, in one batch; nothing waits and ages."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

from unitylink.errors import LinkError, ValueRangeError
from unitylink.layer4_data import ValueGroup

TRIES = 3  # of a write that fails while the link is up


class Inbox:
    """Collect set-points per value, newest wins, while one write is on its way; then write all together.

    A message is taken whole or not at all. `on_silence` is called once when nothing was put for `timeout_s`
    after something was (0: never).
    """

    def __init__(
        self,
        group: ValueGroup,
        complain: Callable[[str], None],
        *,
        timeout_s: float = 0.0,
        on_silence: Callable[[], None] = lambda: None,
    ) -> None:
        self.accepted = self.writes = self.failed = 0
        self._group = group
        self._complain = complain
        self._timeout_s = timeout_s
        self._on_silence = on_silence
        self._pending: dict[str, Any] = {}
        self._changed = threading.Condition()
        self._busy = self._closed = False
        self._thread = threading.Thread(target=self._run, name="unitylink-ros-inbox", daemon=True)
        self._thread.start()

    def put(self, numbers: Mapping[str, Any]) -> None:
        """Have values written soon; raise ValueRangeError, and take none, where one cannot be written."""
        for path, number in numbers.items():
            self._group.writes[path].encode(number)
        with self._changed:
            if self._closed:
                raise ValueRangeError("the link is down; nothing was sent")
            self.accepted += 1
            waits = not self._pending  # else it has been told, and has not come to it yet
            self._pending.update(numbers)
            if waits:
                self._changed.notify_all()

    def clear(self) -> None:
        """Forget what waits, and return when what was on its way has arrived."""
        with self._changed:
            self._pending.clear()
            self._changed.wait_for(lambda: not self._busy or self._closed)

    def close(self) -> None:
        with self._changed:
            self._closed = True
            self._pending.clear()
            self._changed.notify_all()
        if self._thread is not threading.current_thread():
            self._thread.join()

    def _run(self) -> None:
        silent_at, tried = float("inf"), 0
        while True:
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                rest = silent_at - time.monotonic()
                if not self._changed.wait_for(
                    lambda: self._pending or self._closed, None if rest == float("inf") else max(0.0, rest)
                ):
                    silent_at = float("inf")
                    numbers = None
                elif self._closed:
                    return
                else:
                    numbers, self._pending = self._pending, {}
                    self._busy = True
            if numbers is None:
                self._on_silence()
                continue
            if self._timeout_s:
                silent_at = time.monotonic() + self._timeout_s
            try:
                self._group.write(numbers)
                self.writes += 1
                tried = 0
            except LinkError as error:
                self.failed += 1
                tried += 1
                self._complain(f"a command was not written: {error}")
                with self._changed:  # it is still what is wanted, but for what has come since
                    if tried < TRIES and not self._closed:
                        self._pending = numbers | self._pending
                    else:
                        tried = 0
