# SPDX-License-Identifier: BSD-3-Clause
"""A thread that takes messages of some topics of DDS. A message that cannot be read does not end it."""

from __future__ import annotations

import ctypes
import logging
import threading
from collections.abc import Callable
from importlib import import_module
from typing import Any

from .life import Life
from .plane import Refuse, log_refused

_log = logging.getLogger("unitylink.ros")
TAKE_AT_ONCE = 64
WAIT_NS = 100_000_000


class DdsReader:
    """Calls `take(message)` for each message of the topics added before `start`.

    `life` sees the thread under the name `what`.
    """

    def __init__(self, participant: Any, what: str, life: Life) -> None:
        self._participant, self._what, self._life = participant, what, life
        self._takers: list[tuple[Any, str, Callable[[Any], None], Refuse]] = []
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name=f"unitylink-ros-{what}", daemon=True)

    def add(self, reader: Any, topic: str, take: Callable[[Any], None], refuse: Refuse = log_refused) -> None:
        self._takers.append((reader, topic, take, refuse))

    def start(self) -> None:
        if self._takers:  # DDS cannot wait without any reader
            self._thread.start()

    def close(self) -> None:
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join()

    def _run(self) -> None:
        from cyclonedds.core import (
            DDSException,
            InstanceState,
            ReadCondition,
            SampleState,
            ViewState,
            WaitSet,
        )

        fresh = ViewState.Any | InstanceState.Any | SampleState.NotRead
        waiting = WaitSet(self._participant)
        conditions = [ReadCondition(reader, fresh) for reader, *_ in self._takers]
        for condition in conditions:
            waiting.attach(condition)
        # These tell which readers have something. Asking every reader would cost a node with many topics more
        # than a message.
        marks = [ctypes.addressof(mark) for _, mark in waiting.attached]
        takers = dict(zip(marks, self._takers, strict=True))
        found = (ctypes.c_void_p * len(marks))()
        while not self._stop.is_set():
            self._life.beat(self._what)
            count = waiting._waitset_wait(waiting._ref, found, len(marks), WAIT_NS)
            if count < 0:
                raise DDSException(count, "while waiting for messages")
            for mark in found[:count]:
                self._take_all(*takers[mark or 0])
        self._life.rest()

    def _take_all(self, reader: Any, topic: str, take: Callable[[Any], None], refuse: Refuse) -> None:
        from cyclonedds.core import DDSException, InstanceState, SampleState, ViewState

        any_state = SampleState.Any | ViewState.Any | InstanceState.Any
        taken = import_module("cyclonedds._clayer").ddspy_take(
            reader._ref, any_state, TAKE_AT_ONCE
        )  # as bytes, because DataReader.take reads all messages or none
        if isinstance(taken, int):
            raise DDSException(taken, f"while taking from {topic}")
        kind = reader._topic.data_type
        for data, info in taken:
            if not info.valid_data:  # a writer has come or gone
                continue
            try:
                message = kind.deserialize(data)
                message.sample_info = info
            # for example a name that is not UTF-8, or a length beyond the message's end
            except Exception as error:
                refuse(topic, error)
                continue
            try:
                take(message)
            except Exception:
                _log.exception("a message on %s was not taken", topic)
