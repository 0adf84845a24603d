# SPDX-License-Identifier: BSD-3-Clause
"""An iteration over publishes starts with the newest and gives each one once, whatever their times are."""

from __future__ import annotations

import asyncio
from collections.abc import Callable

import pytest

from unitylink.layer4_data.listeners import Listeners

Pair = tuple[float, int]


def told(
    listeners: Listeners[int], newest: Callable[[], Pair | None], then: list[Pair], count: int
) -> list[Pair]:
    async def some() -> list[Pair]:
        found = []
        async for one in listeners.stream(lambda: None, lambda: True, newest):
            found.append(one)
            while then:
                listeners.tell(*then.pop(0))
            if len(found) == count:
                break
        return found

    return asyncio.run(asyncio.wait_for(some(), 30))


@pytest.mark.parametrize("time_s", [9.0, 10.0, 11.0])
def test_a_change_is_reported_even_with_an_earlier_time_than_the_first_value(time_s: float) -> None:
    """The PC read the first value, at the PC's time. The device's clock may be behind."""
    found = told(Listeners("x"), lambda: (10.0, 0), [(time_s, 1), (12.0, 2)], 3)
    assert found == [(10.0, 0), (time_s, 1), (12.0, 2)]


def test_a_publish_that_comes_during_the_request_for_the_newest_is_given_once() -> None:
    listeners: Listeners[int] = Listeners("x")

    def newest() -> Pair:
        listeners.tell(10.0, 5)
        return 10.0, 5

    assert told(listeners, newest, [(11.0, 6)], 2) == [(10.0, 5), (11.0, 6)]
