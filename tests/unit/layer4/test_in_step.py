# SPDX-License-Identifier: BSD-3-Clause
"""Sets of values that come at several rates and on events.

Values of one rate are in step, with the newest of all others.
"""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from queue import Queue
from typing import Any

import pytest

from unitylink import Link
from unitylink.layer4_data import ReadValue, Snapshot, load_spec_objects
from unitylink.layer4_data.sets import Sets
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import Spec, compile_text

TEXT = """
public several() {
   @a = 0x10: u16 READ(PUBLISH(1, 10));
   @b = 0x11: u16 READ(PUBLISH(1, 10));
   @slow = 0x12: u16 READ(PUBLISH(1, 60000));
   @flag = 0x13: u16 READ(PUBLISH(on change));
   lamp: lamp() @ (0x14);
}
lamp(): @ (on) { @on: bool READ(PUBLISH(on change)); }"""
PATIENCE_S = 30


def spec_of(text: str = TEXT) -> Spec:
    spec = compile_text(text, "several.ul").spec
    assert spec is not None
    return spec


def sets(protocol: str, *publishes: tuple[str, int, int]) -> list[dict[str, int]]:
    """Return the sets that these publishes make. Each publish is (value, time in ms, number)."""
    spec = spec_of()
    configuration = BoardConfiguration.for_spec(spec, protocol=protocol)
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=2") as link:
        robot = load_spec_objects(spec, link)
        values = {name: robot[name] for name in sorted({name for name, _, _ in publishes})}
        reads = {name: value for name, value in values.items() if isinstance(value, ReadValue)}
        made = Sets(reads, {link: link.url})
        made.expect({value: value.publisher.planned(value) for value in reads.values()})
        made.begin()
        told = [made.take(time_ms / 1000, [reads[name]], [number]) for name, time_ms, number in publishes]
        return [dict(snapshot) for snapshot in told if snapshot is not None]


def pairs(found: list[dict[str, int]]) -> list[tuple[int, int]]:
    return [(one["a"], one["b"]) for one in found]


LOSS = (("a", 0, 0), ("b", 0, 0), ("b", 10, 1), ("a", 20, 2), ("b", 20, 2), ("a", 30, 3), ("b", 30, 3))


def test_after_a_loss_the_next_set_is_of_one_tick() -> None:
    assert pairs(sets("both", *LOSS)) == [(0, 0), (2, 2), (3, 3)]


def test_without_the_device_s_times_ticks_cannot_be_told_apart() -> None:
    assert pairs(sets("classic", *LOSS)) == [(0, 0), (2, 1), (3, 2)]


def test_each_rate_and_each_event_has_its_beat() -> None:
    found = sets("both", ("slow", 0, 9), ("a", 10, 1), ("a", 20, 2), ("flag", 25, 7), ("slow", 60000, 8))
    assert found == [
        {"slow": 9},  # a value that has not come yet is left out
        {"slow": 9, "a": 1},
        {"slow": 9, "a": 2},
        {"slow": 9, "a": 2, "flag": 7},
        {"slow": 8, "a": 2, "flag": 7},
    ]


class Still:
    """A plant in which nothing moves. The tests set the words."""

    period_s = 0.001

    def attach(self, spec: object, registers: object) -> None:
        """Need nothing."""

    def step(self, time_s: float) -> None:
        """Change nothing."""


@pytest.fixture
def board() -> Iterator[Board]:
    with Board(spec_of(), plant=Still()) as board:
        board.registers[0x12], board.registers[0x13] = 5, 6
        yield board


def test_a_node_gives_sets_at_its_fastest_rate(board: Board) -> None:
    """`slow` comes once a minute and the flags on change. No set waits for them, and each set has them."""
    told: Queue[tuple[float, Snapshot]] = Queue()
    with Link(f"{board.url}?timeout=10") as link:
        robot = load_spec_objects(spec_of(), link)
        take_back = robot.on_publish(lambda time_s, snapshot: told.put((time_s, snapshot)))
        came = [told.get(timeout=PATIENCE_S) for _ in range(12)]
        for time_s, snapshot in came:
            assert (snapshot["slow"], snapshot["flag"], snapshot["lamp.on"]) == (5, 6, False)
            assert snapshot.time_s >= time_s and max(snapshot.sampled_s.values()) == snapshot.time_s
        ticks = [snapshot.sampled_s["a"] for _, snapshot in came if snapshot.sampled_s["a"] == _]
        assert len(ticks) >= 9 and ticks == sorted(set(ticks)), "the sets come with a and b"
        board.registers[0x13] = 66
        while told.get(timeout=PATIENCE_S)[1]["flag"] != 66:
            pass
        take_back()
        robot.stop_publishing()


@pytest.mark.parametrize("running", [False, True], ids=["not yet publishing", "publishing"])
@pytest.mark.parametrize("name", ["lamp.on", "lamp"])
def test_an_iteration_over_publishes_on_change_begins_with_the_current_value(
    board: Board, name: str, running: bool
) -> None:
    async def first_two(robot: Any) -> list[Any]:
        found = []
        async for _, value in robot[name].publishes():
            found.append(value)
            if len(found) == 2:
                break
            board.registers[0x14] = 1
        return found

    with Link(f"{board.url}?timeout=10") as link:
        robot: Any = load_spec_objects(spec_of(), link)
        if running:
            begun: Queue[bool] = Queue()
            robot.lamp.on.on_publish(lambda _, on: begun.put(on))
            assert begun.get(timeout=PATIENCE_S) is False
        found = asyncio.run(asyncio.wait_for(first_two(robot), PATIENCE_S))
    assert [value if name == "lamp.on" else value["on"] for value in found] == [False, True]


def test_the_first_value_is_published_once(board: Board) -> None:
    """A listener that is there when publishing starts gets the first value, with the time of the start.

    It comes before any change.
    """
    told: Queue[tuple[float, int]] = Queue()
    with Link(f"{board.url}?timeout=10") as link:
        robot = load_spec_objects(spec_of(), link)
        value = robot["flag"]
        assert isinstance(value, ReadValue)
        before_s = link.now_s()
        with robot.record() as recording:
            value.on_publish(lambda time_s, number: told.put((time_s, number)))
            first_s, first = told.get(timeout=PATIENCE_S)
            assert before_s <= first_s <= link.now_s()
            board.registers[0x13] = 7
            then_s, then = told.get(timeout=PATIENCE_S)
            robot.stop_publishing()
        times_s, numbers = recording.series("flag")
        assert numbers.tolist() == [6, 7] == [first, then]
        assert times_s.tolist() == [first_s, then_s] == sorted(times_s)


def test_a_value_that_a_read_changes_is_not_read_for_a_set() -> None:
    spec = spec_of("""
        public drive() {
           @pos = 0x10: u16 READ(PUBLISH(1, 10));
           @steps = 0x11: u16 READCLEAR(PUBLISH(on change));
        }""")
    told: Queue[Snapshot] = Queue()
    with Board(spec, plant=Still()) as still, Link(f"{still.url}?timeout=10") as link:
        robot = load_spec_objects(spec, link)
        robot.on_publish(lambda _, snapshot: told.put(snapshot))
        assert dict(told.get(timeout=PATIENCE_S)) == {"pos": 0}
        robot.stop_publishing()
