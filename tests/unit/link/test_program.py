# SPDX-License-Identifier: BSD-3-Clause
"""A link that watches its program: the dead-man trips if the program hangs, though its process lives."""

from __future__ import annotations

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest
from unit.link.reconnect_rig import PATIENCE_S, SCRATCH, kinds, until

from unitylink import Link, connect
from unitylink.errors import DeadManTripped, LinkClosed, LinkDown, ValueRangeError
from unitylink.simulate import Board
from unitylink.spec import compile_text

SPEC = compile_text("public one() {\n   @a = 0x10: i16 READWRITE(SAFE=3);\n}\n", "one.ul").spec
WORKED_S = 0.5  # a busy machine must not look like a program that hangs


@pytest.fixture
def board() -> Iterator[Board]:
    with Board(SPEC, endpoint="tcp") as made:
        yield made


@contextmanager
def working(link: Link) -> Iterator[None]:
    """A program that gives its sign of life from another thread."""
    over = threading.Event()

    def work() -> None:
        while not over.wait(0.02):
            link.alive()

    thread = threading.Thread(target=work)
    thread.start()
    try:
        yield
    finally:
        over.set()
        thread.join()


def test_a_program_that_hangs_lets_the_dead_man_trip_and_goes_on_when_it_works_again(board: Board) -> None:
    with connect(f"{board.url}?timeout=5&deadman=0.2", reconnect=True) as link:
        publishes = link.subscribe([SCRATCH], divisor=5)
        link.watch_program(WORKED_S)
        with working(link):
            link.write(0x10, 7)
            # longer than the limit, so without the signs of life the dead-man would trip
            time.sleep(2 * WORKED_S)
            assert kinds(link) == []
            assert board.registers[0x10] == 7
        until(lambda: board.registers[0x10] == 3)  # only the gateware can have written it
        assert kinds(link) == ["lost"]
        assert "the program gave no sign of life for 500" in link._native.events(0)[0][0][2]
        with pytest.raises(LinkDown, match="no sign of life"):
            link.write(0x10, 8)
        with working(link):
            assert link.wait_up(PATIENCE_S)
            with pytest.raises(DeadManTripped):
                link.write(0x10, 8)
            link.arm()
            link.write(0x10, 9)
            publishes.drain()
            assert publishes.wait(PATIENCE_S)
        assert board.registers[0x10] == 9


def test_a_program_that_only_reads_still_needs_a_sign_of_life(board: Board) -> None:
    """A thread that reads is no sign that the deciding thread works."""
    with connect(f"{board.url}?timeout=5&deadman=0.2", reconnect=True) as link:
        link.watch_program(0.05)
        with pytest.raises(LinkDown):
            while True:
                link.read(0x10)
        until(lambda: board.registers[0x10] == 3)
        link.watch_program(0)  # the program is not watched any more
        assert link.wait_up(PATIENCE_S)
        time.sleep(0.1)
        assert link.read(0x10) == 3


def test_a_link_that_does_not_come_back_ends(board: Board) -> None:
    with connect(f"{board.url}?timeout=5") as link:
        link.watch_program(0.05)
        until(lambda: link.closed)
        with pytest.raises(LinkClosed, match="no sign of life"):
            link.read(0x10)
        link.alive()  # this comes too late, but is no error


def test_what_is_no_time_is_refused(board: Board) -> None:
    with connect(board.url) as link:
        for wrong in (-1.0, float("nan"), float("inf"), 3601.0):
            with pytest.raises(ValueRangeError):
                link.watch_program(wrong)
        link.alive()
        assert link.read(0x10) == 0
