# SPDX-License-Identifier: BSD-3-Clause
"""When a line comes back, layers 3 and 4 forget the set-points that they kept. So none is repeated."""

from __future__ import annotations

import pytest

from unitylink import connect
from unitylink.errors import LinkDown, ValueRangeError
from unitylink.layer3_hardware import DoubleBufferProxy
from unitylink.layer4_data import load_spec_objects
from unitylink.simulate import Board, BoardConfiguration, DoubleBufferConfiguration, LoopbackPlant
from unitylink.spec import compile_text

PATIENCE_S = 30.0
SPEC = compile_text(
    """public two() {
   @a = 0x10: i16 WRITE(INITIAL=0);
   @b = 0x11: i16 WRITE(INITIAL=0);
   @c = 0x12: i16 READ(PUBLISH(100 Hz));
}""",
    "two.ul",
).spec


def test_a_commit_writes_no_set_point_of_before() -> None:
    configuration = BoardConfiguration(double_buffers=(DoubleBufferConfiguration(base=0x40, size=8),))

    def made(place: str) -> Board:
        return Board(configuration=configuration, endpoint=place)

    board = made("tcp")
    port = board.url.rsplit(":", 1)[1]
    with connect(f"{board.url}?timeout=5", reconnect=True) as link:
        outputs = DoubleBufferProxy(link, base=0x40, size=8)
        outputs.write_many([0, 1], [5, 6])
        assert (board.registers[0x40], board.registers[0x41]) == (5, 6)
        board.close()
        board = made(f"tcp:{port}")
        while not link.statistics().reconnections:
            link.wait_up(PATIENCE_S)
        outputs.write(1, 7)
        assert (board.registers[0x40], board.registers[0x41]) == (0, 7)
    board.close()


def test_a_cycle_asks_for_all_again() -> None:
    with (
        Board(SPEC, plant=LoopbackPlant(), endpoint="tcp") as board,
        connect(f"{board.url}?timeout=5", reconnect=True) as link,
        load_spec_objects(SPEC, link).cycle() as cycle,
    ):
        cycle(a=5, b=6)
        cycle(a=7)
        board.hang_up()
        while not link.statistics().reconnections:
            link.wait_up(PATIENCE_S)
        board.registers[0x11] = 0
        for _ in range(2):
            with pytest.raises((ValueRangeError, LinkDown), match=r"given since the line was lost"):
                cycle(a=8)
        assert board.registers[0x11] == 0
        cycle(a=8, b=9)
        cycle(a=9)
        assert (board.registers[0x10], board.registers[0x11]) == (9, 9)
