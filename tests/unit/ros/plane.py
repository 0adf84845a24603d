# SPDX-License-Identifier: BSD-3-Clause
"""A plane that keeps what it is given, for tests of the node without any ROS."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, nullcontext
from types import SimpleNamespace
from typing import Any

from unitylink.ros.interface import Topic
from unitylink.ros.life import Life
from unitylink.ros.plane import Port
from unitylink.ros.stamps import Stamps

PATIENCE_S = 30.0


class MemoryPlane:
    """Messages are namespaces of their fields. Published messages are kept for each topic."""

    def __init__(self) -> None:
        self.sent: dict[str, list[Any]] = {}
        self.takers: dict[str, Callable[[Any], None]] = {}
        self.services: dict[str, Callable[..., Any]] = {}
        self.said: list[tuple[int, str]] = []
        self._changed = threading.Condition()
        self.life = Life()
        self.stamps = Stamps()

    def maker(self, type_name: str, fields: Sequence[str]) -> Callable[..., Any]:
        names = tuple(fields)
        return lambda *values: SimpleNamespace(**dict(zip(names, values, strict=True)))

    def time(self, time_s: float) -> Any:
        return self.stamps.parts(time_s)

    def header(self, time_s: float, frame: str) -> Any:
        return (time_s, frame)

    def level(self, level: int) -> int:
        return level

    def advertise(self, topic: Topic) -> Port:
        def send(message: Any) -> None:
            with self._changed:
                self.sent.setdefault(topic.name, []).append(message)
                self._changed.notify_all()

        return Port(send, lambda: True)

    def gathered(self) -> AbstractContextManager[None]:
        return nullcontext()  # each message is sent alone

    def subscribe(
        self, topic: Topic, take: Callable[[Any], None], refuse: Callable[[str, Exception], None]
    ) -> None:
        self.takers[topic.name] = take

    def serve(self, name: str, kind: str, handler: Callable[..., Any]) -> None:
        self.services[name] = handler

    def say(self, level: int, message: str) -> None:
        with self._changed:
            self.said.append((level, message))
            self._changed.notify_all()

    def wait(self, holds: Callable[[], bool]) -> None:
        """Wait until the condition holds.

        It is also polled, because what it reads may change elsewhere too.
        """
        deadline = time.monotonic() + PATIENCE_S
        with self._changed:
            while not holds():
                assert time.monotonic() < deadline, (self.said, {k: v[-1:] for k, v in self.sent.items()})
                self._changed.wait(0.02)
