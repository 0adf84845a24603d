# SPDX-License-Identifier: BSD-3-Clause
"""Values, groups and publishing on the virtual SCARA, over a real link."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from unitylink import Link
from unitylink.errors import DeviceMismatch, LinkClosed
from unitylink.layer4_data import Node, Snapshot, ValueGroup, load_spec_objects
from unitylink.simulate import Board, BoardConfiguration, ScaraPlant
from unitylink.spec import load

SPEC = load(Path(__file__).resolve().parents[3] / "examples" / "scara" / "scara.ul")


@pytest.fixture
def scara() -> Iterator[tuple[Board, Node]]:
    with Board(SPEC, plant=ScaraPlant()) as board, Link(f"{board.url}?timeout=10") as link:
        yield board, load_spec_objects(SPEC, link)


def at(node: Node, path: str) -> Any:
    return node[path]


def test_it_goes_where_it_is_told(scara: tuple[Board, Node]) -> None:
    _, robot = scara
    targets = {"j1": 300, "j2": -400, "j3": 500, "j4": -600}
    group = ValueGroup([value for value in robot if value.access == "WRITE"], "commands")
    there = threading.Event()

    def look(time_s: float, values: Snapshot) -> None:
        if all(abs(values[f"{joint}.cpos"] - count) <= 1 for joint, count in targets.items()):
            there.set()

    robot.on_publish(look)
    group.write({f"{j}.spd_sp": 20000 for j in targets} | {f"{j}.pos_sp": n for j, n in targets.items()})
    assert there.wait(20)
    (report,) = robot.publisher.reports()
    assert report.hardware and report.rate_hz == 100.0 and len(report.paths) == 8
    robot.stop_publishing()
    assert robot.snapshot()["j2.cpos"] == pytest.approx(-400, abs=1)
    assert at(robot, "j3.cpos").read() == pytest.approx(500, abs=1)


def test_async(scara: tuple[Board, Node]) -> None:
    board, robot = scara

    async def main() -> int:
        await at(robot, "j1.pos_sp").write_async(-77)
        await ValueGroup([at(robot, "j2.pos_sp"), at(robot, "j3.pos_sp")]).write_async([5, 6])
        values = await asyncio.gather(*(at(robot, f"j{n}.cpos").read_async() for n in range(1, 5)))
        return len(values)

    assert asyncio.run(main()) == 4
    assert [board.registers.signed(0x8C + n) for n in range(3)] == [-77, 5, 6]


def test_async_publishes(scara: tuple[Board, Node]) -> None:
    board, robot = scara

    async def main() -> tuple[list[int], list[Snapshot]]:
        counts, sets = [], []
        async for _, count in at(robot, "j1.cpos").publishes():
            counts.append(count)
            if len(counts) == 3:
                break
        async for _, snapshot in robot.publishes():
            sets.append(snapshot)
            if len(sets) == 2:
                robot.stop_publishing()  # ends the loop after the values that had come before
        return counts, sets

    counts, sets = asyncio.run(asyncio.wait_for(main(), 20))
    assert counts == [0, 0, 0] and len(sets) >= 2 and len(sets[0]) == 8
    assert not board.closed


def test_async_publishes_end_with_the_link(scara: tuple[Board, Node]) -> None:
    board, robot = scara

    async def main() -> int:
        seen = 0
        async for _ in at(robot, "j2.cpos").publishes():
            seen += 1
            board.close()
        return seen

    assert asyncio.run(asyncio.wait_for(main(), 20)) >= 1


def test_software_publishing_beside_hardware() -> None:
    configuration = BoardConfiguration.for_spec(SPEC, groups=1, group_size=6)
    with (
        Board(SPEC, configuration=configuration, plant=ScaraPlant()) as board,
        Link(f"{board.url}?timeout=10") as link,
    ):
        robot = load_spec_objects(SPEC, link)
        with pytest.raises(DeviceMismatch, match="has 1 publish groups of 6 values, 2 are needed"):
            robot.start_publishing()
        got = threading.Event()
        with robot.publishing(fallback=True):
            robot.on_publish(lambda time_s, values: got.set())
            assert got.wait(20)
            assert [report.hardware for report in robot.publisher.reports()] == [True, False]


def test_publishing_ends_cleanly_when_the_board_goes(scara: tuple[Board, Node]) -> None:
    board, robot = scara
    robot.start_publishing()
    board.close()
    with pytest.raises(LinkClosed, match=r"j1\.cpos"):
        while True:
            at(robot, "j1.cpos").read()
    robot.stop_publishing()
