# SPDX-License-Identifier: BSD-3-Clause
"""A thread that takes what comes over Zenoh for a node of ROS 2. Nothing that a peer sends ends it."""

from __future__ import annotations

import logging
import threading
from collections import deque
from collections.abc import Callable
from typing import Any

from .life import Life

_log = logging.getLogger("unitylink.ros")
_WAIT_S = 0.1


class ZenohReader:
    """Takes samples and queries in the order in which they came. `life` sees the thread as `what`."""

    def __init__(self, what: str, life: Life) -> None:
        self._what, self._life = what, life
        self._boxes: list[tuple[str, deque[Any], Callable[[Any], None]]] = []
        self._news = threading.Event()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"unitylink-ros-{what}", daemon=True)

    def box(self, name: str, depth: int, take: Callable[[Any], None]) -> Callable[[Any], None]:
        """Return what Zenoh may call: it keeps the newest `depth` for `take`, and never waits."""
        kept: deque[Any] = deque(maxlen=depth)
        self._boxes.append((name, kept, take))

        def come(one: Any) -> None:
            kept.append(one)
            self._news.set()

        return come

    def start(self) -> None:
        self._thread.start()

    def close(self) -> None:
        self._stop.set()
        self._news.set()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        while not self._stop.is_set():
            self._life.beat(self._what)
            self._news.wait(_WAIT_S)
            self._news.clear()
            for name, kept, take in self._boxes:
                for _ in range(len(kept)):  # not what comes meanwhile: the other boxes have their turn
                    try:
                        take(kept.popleft())
                    except Exception:
                        _log.exception("what came for %s was not taken", name)
        self._life.rest()
