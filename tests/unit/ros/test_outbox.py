# SPDX-License-Identifier: BSD-3-Clause
"""Routes from publishes to topics.

A topic of several gateware groups is sent once per tick, with values of one tick.
"""

from __future__ import annotations

import pytest

from unitylink.ros.outbox import _Join


@pytest.mark.parametrize("late", [False, True], ids=["whole from the start", "begun in the middle of a tick"])
def test_parts_of_one_tick_belong_together(late: bool) -> None:
    sent: list[tuple[float, list[int]]] = []
    join = _Join(("a", "b", "c"), lambda time_s, numbers: sent.append((time_s, list(numbers))), 0.01)
    first, second = join.part(["a", "c"]), join.part(["b"])
    if late:
        second(0.9901, [-1])  # from the tick before; its other half passed before we listened
    for tick in range(3):
        first(1.0 + tick * 0.01, [tick, tick])
        second(1.0001 + tick * 0.01, [tick])
    assert sent == [(pytest.approx(1.0001 + tick * 0.01), [tick] * 3) for tick in range(3)]
