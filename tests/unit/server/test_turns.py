# SPDX-License-Identifier: BSD-3-Clause
"""Clients that wait for the same line: whose turn it is, and which reads are one. Counted, not timed."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack
from pathlib import Path

import pytest

from tests.unit.server.held_wire import HeldWire, held
from tests.unit.server.served import Served, served
from tests.unit.server.test_serving import until
from unitylink import Link
from unitylink.capture.messages import messages
from unitylink.capture.pcapng import read_packets
from unitylink.simulate import Board, BoardConfiguration
from unitylink.spec import compile_text

TEXT = """
public arm() {
   @gain = 0x13: u16 READWRITE();
   @errors = 0x14: u16 READCLEAR();
   @target = 0x1A: i32 WRITE(SAFE=0);
}
"""
SPEC = compile_text(TEXT, "arm.ul").spec
WINDOW = 16  # requests that this board takes at a time
HELD = 4  # and that wait in the link: `held_most` of upstream.cpp
GAIN, ERRORS = 0x13, 0x14
OTHERS = (
    0x50,
    0x51,
    0x52,
    0x53,
)  # words that the spec does not name: nobody knows whether reading them does something


@pytest.fixture
def rig(tmp_path: Path) -> Iterator[tuple[Served, HeldWire, Path]]:
    configuration = BoardConfiguration.for_spec(SPEC, window=WINDOW)
    board = Board(SPEC, configuration=configuration, endpoint="tcp")
    wire, trace = HeldWire(board.url), tmp_path / "line.pcapng"
    try:
        with served(board, f"{wire.url}?timeout=20&trace={trace}", SPEC) as one:
            yield one, wire, trace
    finally:
        wire.close()


def asked(trace: Path) -> list[int]:
    """Return the addresses that were read on the line, in order. What was sent again counts once."""
    sent = {message.text: message.meaning for message in messages(read_packets(trace))}
    return [int(meaning.split()[-1], 16) for text, meaning in sent.items() if text.startswith("READ ")]


def flood(pool: ThreadPoolExecutor, link: Link, address: int, count: int = 16) -> list[Future[int]]:
    return [pool.submit(link.read, address) for _ in range(count)]


def waiting(one: Served) -> int:
    return int(one.robot.report()["waiting"])


def test_equal_reads_that_wait_together_are_one(rig: tuple[Served, HeldWire, Path]) -> None:
    one, wire, trace = rig
    with ExitStack() as stack, ThreadPoolExecutor(60) as pool:
        first, second, *links = [stack.enter_context(one.link()) for _ in range(7)]
        with held(wire):
            others = [*flood(pool, first, OTHERS[0]), *flood(pool, second, OTHERS[0])]
            until(lambda: waiting(one) == 32 - WINDOW - HELD)
            gains = [pool.submit(link.read, GAIN) for link in links]
            errors = [pool.submit(link.read, ERRORS) for link in links]
            until(lambda: one.robot.report()["joined"] == 4 and waiting(one) == 12 + 1 + 5)
            one.board.registers[GAIN] = 77  # after all have asked, and before the board is
            applied_s = one.board.time_s + 0.01
            until(lambda: one.board.time_s > applied_s)
        assert [gain.result() for gain in gains] == [77] * 5
        assert [other.result() for other in (*others, *errors)] == [0] * 37
    one.server.close()
    read = asked(trace)
    assert (read.count(GAIN), read.count(ERRORS), read.count(OTHERS[0])) == (1, 5, 32)


def test_a_read_never_gets_a_value_from_before_it_was_asked(rig: tuple[Served, HeldWire, Path]) -> None:
    one, _, _ = rig
    confirmed, over = 0, threading.Event()

    def look(link: Link) -> None:
        while not over.is_set():
            before = confirmed
            assert link.read(GAIN) >= before

    with ExitStack() as stack, ThreadPoolExecutor(40) as pool:
        writer, *links = [stack.enter_context(one.link()) for _ in range(25)]
        looks = [pool.submit(look, link) for link in links]
        try:
            while confirmed < 300 or one.robot.report()["joined"] < 20:
                writer.write(GAIN, confirmed + 1)
                confirmed += 1
        finally:
            over.set()
        for done in looks:
            done.result()


def test_a_flood_goes_before_nobody_by_more_than_its_turn(rig: tuple[Served, HeldWire, Path]) -> None:
    one, wire, trace = rig
    with ExitStack() as stack, ThreadPoolExecutor(80) as pool:
        polite, *floods = [stack.enter_context(one.link()) for _ in range(5)]
        with held(wire):
            told = [
                result
                for link, address in zip(floods, OTHERS, strict=True)
                for result in flood(pool, link, address)
            ]
            until(lambda: waiting(one) == 64 - WINDOW - HELD)
            mine = pool.submit(polite.read, GAIN)
            until(lambda: waiting(one) == 65 - WINDOW - HELD)
        for result in (*told, mine):
            result.result()
    one.server.close()
    read = asked(trace)
    assert len(read) == 65
    assert read.index(GAIN) <= WINDOW + HELD + len(OTHERS)  # of 64 that were asked before


def test_a_user_with_many_connections_gets_the_share_of_one(rig: tuple[Served, HeldWire, Path]) -> None:
    one, wire, trace = rig
    with ExitStack() as stack, ThreadPoolExecutor(80) as pool:
        floods = [stack.enter_context(one.link("all")) for _ in range(8)]
        polite = stack.enter_context(one.link("looks"))
        with held(wire):
            told = [result for link in floods for result in flood(pool, link, OTHERS[0], 8)]
            until(lambda: waiting(one) == 64 - WINDOW - HELD)
            mine = [pool.submit(polite.read, address) for address in OTHERS[1:]]
            until(lambda: waiting(one) == 67 - WINDOW - HELD)
        for result in (*told, *mine):
            result.result()
    one.server.close()
    read = asked(trace)
    places = sorted(read.index(address) for address in OTHERS[1:])
    assert len(read) == 67
    assert all(place <= WINDOW + HELD + 2 * turn for turn, place in enumerate(places, 1))  # every second one


def test_who_has_joined_a_read_gets_it_though_the_first_has_gone(
    rig: tuple[Served, HeldWire, Path],
) -> None:
    one, wire, trace = rig
    with ExitStack() as stack, ThreadPoolExecutor(60) as pool:
        busy, more, stays = (stack.enter_context(one.link()) for _ in range(3))
        goes = one.link()
        with held(wire):
            others = [*flood(pool, busy, OTHERS[0]), *flood(pool, more, OTHERS[0])]
            until(lambda: waiting(one) == 12)
            lost = pool.submit(goes.read, GAIN)
            until(lambda: waiting(one) == 13)
            kept = pool.submit(stays.read, GAIN)
            until(lambda: one.robot.report()["joined"] == 1)
            goes.close()
            until(lambda: len(one.robot.report()["clients"]) == 3)
            assert waiting(one) == 13
        assert lost.exception() is not None
        assert kept.result() == 0
        for other in others:
            other.result()
    one.server.close()
    assert asked(trace).count(GAIN) == 1
