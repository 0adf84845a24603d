# SPDX-License-Identifier: BSD-3-Clause
"""From topics to the gateware.

The newest commands are written in one batch, and none waits until it is old.
"""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Mapping
from typing import Any

from unitylink.errors import LinkDown, ValueRangeError
from unitylink.layer4_data import ValueGroup

from .life import DEVICE_S, Life

TRIES = 3  # for a write that fails while the link is up
LOOK_S = 0.1  # how often the thread shows that it lives
WRITES = "the thread that writes commands"


class Inbox:
    """Collect set-points during a write. The newest one of each value counts.

    Then write all of them together.

    A message is taken whole or not at all. `on_silence` is called once if nothing comes for `timeout_s` after
    a command. With 0 it is never called. Waiting commands are dropped while `current()` is false, because
    they were meant for the device as it was before.
    """

    def __init__(
        self,
        group: ValueGroup,
        complain: Callable[[str], None],
        *,
        timeout_s: float = 0.0,
        on_silence: Callable[[], None] = lambda: None,
        current: Callable[[], bool] = lambda: True,
        life: Life | None = None,
    ) -> None:
        self.accepted = self.writes = self.failed = 0
        self._group = group
        self._complain = complain
        self._timeout_s = timeout_s
        self._on_silence, self._current = on_silence, current
        self._life = life if life is not None else Life()
        self._pending: dict[str, Any] = {}
        self._changed = threading.Condition()
        self._busy = self._closed = False
        self._thread = threading.Thread(target=self._run, name="unitylink-ros-inbox", daemon=True)
        self._thread.start()

    def put(self, numbers: Mapping[str, Any]) -> None:
        """Let values be written soon.

        If one of them cannot be written, raise ValueRangeError and take none.
        """
        for path, number in numbers.items():
            self._group.writes[path].encode(number)
        with self._changed:
            if self._closed:
                raise ValueRangeError("the link is down; nothing was sent")
            self.accepted += 1
            waits = not self._pending  # if it is not waiting, it has been notified, but has not run yet
            self._pending.update(numbers)
            if waits:
                self._changed.notify_all()

    def forget(self) -> None:
        """Forget the waiting commands."""
        with self._changed:
            self._pending.clear()

    def clear(self) -> None:
        """Forget the waiting commands. Return when the current write has arrived."""
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
            self._life.beat(WRITES)
            with self._changed:
                self._busy = False
                self._changed.notify_all()
                rest = min(LOOK_S, max(0.0, silent_at - time.monotonic()))
                self._changed.wait_for(lambda: self._pending or self._closed, rest)
                if self._closed:
                    self._life.rest()
                    return
                numbers, self._pending = self._pending, {}
                self._busy = bool(numbers)
            with self._life.work(WRITES, DEVICE_S):
                if numbers:
                    silent_at = time.monotonic() + self._timeout_s if self._timeout_s else float("inf")
                    tried = 0 if self._written(numbers) else self._again(numbers, tried + 1)
                elif time.monotonic() >= silent_at:
                    silent_at = float("inf")
                    self._on_silence()

    def _written(self, numbers: Mapping[str, Any]) -> bool:
        try:
            if not self._current():
                raise LinkDown("the link was lost meanwhile")
            self._group.write(numbers)
        except Exception as error:  # a defect in one command must not end all commands
            self.failed += 1
            self._complain(f"a command was not written: {error if str(error) else repr(error)}")
            return False
        self.writes += 1
        return True

    def _again(self, numbers: Mapping[str, Any], tried: int) -> int:
        """Let it be written again, because it is still wanted. Values with a newer set-point are left out."""
        with self._changed:
            if tried >= TRIES or self._closed or not self._current():
                return 0
            self._pending = {**numbers, **self._pending}
        return tried
