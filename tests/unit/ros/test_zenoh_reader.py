# SPDX-License-Identifier: BSD-3-Clause
"""What takes messages over Zenoh: a flood on one topic holds up neither the others nor the end."""

from __future__ import annotations

import threading
import time
from collections.abc import Callable
from typing import Any

from unitylink.ros.life import Life
from unitylink.ros.zenoh_reader import ZenohReader

WITHIN_S = 10.0


def test_a_flood_on_one_topic_leaves_the_others_their_turn_and_the_thread_its_signs() -> None:
    life, over = Life(patience_s=0.05), threading.Event()
    reader = ZenohReader("the thread", life)
    come: dict[str, Callable[[Any], None]] = {}
    taken: list[Any] = []

    def again(one: Any) -> None:
        if not over.is_set():
            come["flood"](one)  # as a peer that sends faster than the thread takes

    come["flood"] = reader.box("flood", 16, again)
    come["quiet"] = reader.box("quiet", 16, taken.append)
    come["flood"](1)
    reader.start()
    try:
        time.sleep(0.1)
        come["quiet"](2)
        limit_s = time.monotonic() + WITHIN_S
        while not taken and time.monotonic() < limit_s:
            time.sleep(0.001)
        assert taken == [2] and not life.trouble()
        closing = threading.Thread(target=reader.close, daemon=True)
        closing.start()
        closing.join(WITHIN_S)
        assert not closing.is_alive()
    finally:
        over.set()


def test_what_cannot_be_taken_ends_nothing_and_the_newest_are_kept() -> None:
    reader = ZenohReader("the thread", Life())
    taken: list[float] = []
    come = reader.box("numbers", 3, lambda one: taken.append(1 / one))
    for number in (5, 4, 2, 0, 1):
        come(number)
    reader.start()
    limit_s = time.monotonic() + WITHIN_S
    while len(taken) < 2 and time.monotonic() < limit_s:
        time.sleep(0.001)
    reader.close()
    assert taken == [0.5, 1.0]
