# SPDX-License-Identifier: BSD-3-Clause
"""Sets over several gateware groups stay in step when a publish of one of them is lost."""

from __future__ import annotations

from unitylink import Link
from unitylink.layer4_data import ReadValue, Snapshot, ValueGroup, load_spec_objects
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text

TEXT = """
public two() {
   @a = 0x10: u16 READ(PUBLISH(1, 10));
   @b = 0x11: u16 READ(PUBLISH(1, 10));
   @slow = 0x12: u16 READ(PUBLISH(1, 100));
}"""


def sets(protocol: str, *publishes: tuple[str, int, int]) -> list[tuple[int, ...]]:
    """Return the sets that these publishes make: of a value, at a time in ms, a number."""
    spec = compile_text(TEXT, "two.ul").spec
    assert spec is not None
    configuration = BoardConfiguration.for_spec(spec, protocol=protocol)
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=2") as link:
        robot = load_spec_objects(spec, link)
        names = sorted({name for name, _, _ in publishes})
        values = {name: robot[name] for name in names}
        group = ValueGroup({n: v for n, v in values.items() if isinstance(v, ReadValue)})
        told: list[Snapshot] = []
        group.listeners.on_publish(lambda _time_s, snapshot: told.append(snapshot))
        for value in group.reads.values():
            value.groups += (group,)
        for name, time_ms, number in publishes:
            group.take(time_ms / 1000, [group.reads[name]], [number])
        return [tuple(snapshot.values()) for snapshot in told]


LOSS = (("a", 0, 0), ("b", 0, 0), ("b", 10, 1), ("a", 20, 2), ("b", 20, 2), ("a", 30, 3), ("b", 30, 3))


def test_after_a_loss_the_next_set_is_of_one_tick() -> None:
    assert sets("both", *LOSS) == [(0, 0), (2, 2), (3, 3)]


def test_without_the_times_of_the_device_it_cannot_be_known() -> None:
    assert sets("classic", *LOSS) == [(0, 0), (2, 1), (3, 2)]


def test_the_slowest_sets_the_pace() -> None:
    fast = [("a", 10 * n, n) for n in range(12)]
    assert sets("both", *fast[:11], ("slow", 100, 5), fast[11]) == [(10, 5)]
    assert sets("both", ("slow", 0, 4), *fast[:3]) == [(0, 4)]


def test_links_whose_clocks_differ_keep_making_sets() -> None:
    """Two boards, two clocks: one link's times may stay 50 ms behind the other's."""
    spec = compile_text(TEXT, "two.ul").spec
    assert spec is not None
    configuration = BoardConfiguration.for_spec(spec, protocol="framed")
    with (
        Board(configuration=configuration) as left,
        Board(configuration=configuration) as right,
        Link(f"{left.url}?timeout=2") as one,
        Link(f"{right.url}?timeout=2") as other,
    ):
        reads = [load_spec_objects(spec, link)["a"] for link in (one, other)]
        group = ValueGroup({"left": reads[0], "right": reads[1]})
        told: list[tuple[int, ...]] = []
        group.listeners.on_publish(lambda _time_s, snapshot: told.append(tuple(snapshot.values())))
        for read in group.reads.values():
            read.groups += (group,)
        for tick in range(5):
            group.take(tick / 100, [group.reads["left"]], [tick])
            group.take(tick / 100 - 0.05, [group.reads["right"]], [tick])
        assert told == [(tick, tick) for tick in range(5)]
