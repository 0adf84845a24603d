# SPDX-License-Identifier: BSD-3-Clause
"""Samples come out in the order of their times, whatever the order in which they come in."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from unitylink.recording.reorder_buffer import ReorderBuffer

HOLD_S = 1.0


@given(
    st.lists(st.tuples(st.floats(0, 10), st.floats(0, HOLD_S)), max_size=50),  # (time, delay of its arrival)
    st.lists(st.floats(0, 10), max_size=20),  # the times at which samples are taken out
)
def test_things_that_come_within_the_hold_time_come_out_in_order(
    things: list[tuple[float, float]], looks: list[float]
) -> None:
    held = ReorderBuffer[float](HOLD_S)
    given_out: list[float] = []
    arrivals = [(time_s + late_s * 0.999, time_s) for time_s, late_s in things]
    for now_s, time_s in sorted([*arrivals, *((look, -1.0) for look in looks)]):
        if time_s >= 0:
            assert held.put(time_s, time_s)
        while (one := held.take(now_s)) is not None:
            assert one + HOLD_S <= now_s
            given_out.append(one)
    while (one := held.take_last()) is not None:
        given_out.append(one)
    assert given_out == sorted(time_s for time_s, _ in things)


def test_things_that_come_later_are_dropped() -> None:
    held = ReorderBuffer[str](HOLD_S)
    assert held.put(5.0, "a") and held.take(6.0) == "a"
    assert not held.put(4.9, "too late") and held.put(5.0, "at the same time")


def test_without_a_hold_time_things_come_out_as_they_were_put_in() -> None:
    held = ReorderBuffer[str](0.0)
    for time_s, thing in ((3.0, "a"), (1.0, "b"), (2.0, "c")):
        assert held.put(time_s, thing)
    assert [held.take(0.0) for _ in range(4)] == ["a", "b", "c", None]
