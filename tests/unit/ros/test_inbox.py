# SPDX-License-Identifier: BSD-3-Clause
"""The newest wins: the next write has the newest value of each item, however many came meanwhile."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from typing import Any

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.errors import LinkTimeout, ValueRangeError
from unitylink.ros.inbox import TRIES, Inbox


class SlowGroup:
    """The part of a ValueGroup that the inbox needs. Each write waits until the test lets it through."""

    def __init__(self, *paths: str) -> None:
        self.writes = dict.fromkeys(paths, self)
        self.log: list[dict[str, Any]] = []
        self.begun, self.gate = threading.Semaphore(0), threading.Semaphore(0)
        self.fail = False

    def encode(self, number: Any) -> int:
        if number is None:
            raise ValueRangeError("not a number")
        return int(number)

    def write(self, numbers: Mapping[str, Any]) -> None:
        self.log.append(dict(numbers))
        self.begun.release()
        assert self.gate.acquire(timeout=30)
        if self.fail:
            raise LinkTimeout("no answer")


@settings(max_examples=many(30))
@given(st.lists(st.dictionaries(st.sampled_from("abc"), st.integers(), min_size=1), min_size=1, max_size=20))
def test_newest_wins_and_nothing_ages(messages: list[dict[str, int]]) -> None:
    group = SlowGroup("a", "b", "c")
    inbox = Inbox(group, lambda text: None)  # type: ignore[arg-type]
    inbox.put({"a": -1})
    assert group.begun.acquire(timeout=30)
    newest: dict[str, int] = {}
    for message in messages:  # during the first write
        inbox.put(message)
        newest |= message
    group.gate.release(2)
    assert group.begun.acquire(timeout=30)
    inbox.clear()
    inbox.close()
    assert group.log == [{"a": -1}, newest]
    assert (inbox.accepted, inbox.writes) == (len(messages) + 1, 2)


def test_a_message_is_taken_whole_or_not() -> None:
    group = SlowGroup("a", "b")
    group.gate.release(9)
    inbox = Inbox(group, lambda text: None)  # type: ignore[arg-type]
    with pytest.raises(ValueRangeError):
        inbox.put({"a": 1, "b": None})
    inbox.put({"b": 2})
    assert group.begun.acquire(timeout=30)
    inbox.close()
    assert group.log == [{"b": 2}]
    with pytest.raises(ValueRangeError, match="link is down"):
        inbox.put({"a": 1})


def test_a_failed_write_is_logged_and_tried_again_with_newer_commands() -> None:
    group, said = SlowGroup("a"), list[str]()
    group.fail = True
    group.gate.release(9)
    inbox = Inbox(group, said.append)  # type: ignore[arg-type]
    inbox.put({"a": 1})
    assert group.begun.acquire(timeout=30)
    assert group.begun.acquire(timeout=30) and group.begun.acquire(timeout=30)
    inbox.clear()
    inbox.close()
    assert group.log == [{"a": 1}] * TRIES and inbox.failed == TRIES and "no answer" in said[0]
