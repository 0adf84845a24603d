# SPDX-License-Identifier: BSD-3-Clause
"""Batches: any operations in order, in one message if there are frames.

A model of the words gives the expected results.
"""

from __future__ import annotations

import random
from collections.abc import Iterator

import pytest
from reference.line import Line

from unitylink.errors import BusError, DeviceMismatch, ValueRangeError
from unitylink.layer2_message import Batch, Link, Pending
from unitylink.simulate import Board, BoardConfiguration, FifoConfiguration

FIFO = 0x80


@pytest.fixture(params=["both", "classic"])
def link(request: pytest.FixtureRequest) -> Iterator[Link]:
    configuration = BoardConfiguration(protocol=request.param, fifos=(FifoConfiguration(base=FIFO),))
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=5") as link:
        link.board = board
        yield link


def anything(batch: Batch, words: dict[int, int], choose: random.Random) -> list[tuple[Pending, int]]:
    """Put some operations into a batch. Return the expected results of its reads."""
    expected: list[tuple[Pending, int]] = []
    for _ in range(choose.randrange(1, 60)):
        address, value, mask = (choose.randrange(n) for n in (0x40, 1 << 32, 1 << 32))
        kind = choose.randrange(7)
        if kind == 0:
            batch.write(address, value)
            words[address] = value
        elif kind == 1:
            batch.write_masked(address, mask, value)
            words[address] = (words.get(address, 0) & ~mask) | (value & mask)
        elif kind == 2:
            batch.add(address, value)
            words[address] = (words.get(address, 0) + value) % (1 << 32)
        elif kind == 3:
            run = range(address, address + choose.randrange(1, 20))
            batch.write_many(run, [value] * len(run))
            words |= dict.fromkeys(run, value)
        elif kind == 4:
            batch.write_fifo(address, [value, mask] * choose.randrange(1, 9))
            words[address] = mask
        else:
            run = range(address, address + choose.randrange(1, 20))
            expected += [(read, words.get(a, 0)) for a, read in zip(run, batch.read_many(run), strict=True)]
    return expected


@pytest.mark.parametrize("seed", range(4))
def test_operations_are_done_in_order_whatever_they_are(link: Link, seed: int) -> None:
    choose = random.Random(seed)
    words: dict[int, int] = {}
    for _ in range(12):
        with link.batch() as batch:
            expected = anything(batch, words, choose)
        assert [read.value for read, _ in expected] == [word for _, word in expected]
    assert {address: link.board.registers[address] for address in words} == words


def test_runs_are_named_by_their_first_address(link: Link) -> None:
    before = link.statistics()
    with link.batch() as batch:
        batch.write_many(range(0x10, 0x30), [1] * 32)
        batch.read_many(range(0x10, 0x30))
    after = link.statistics()
    if link.protocol == "framed":
        assert after.requests == before.requests + 1
        assert after.bytes_sent - before.bytes_sent < 32 * 4 + 20
        with link.batch(atomic=True) as batch:
            batch.add(0x10, 5)
            word = batch.read(0x10)
        assert word.value == 6
        with pytest.raises(DeviceMismatch, match="of these 100 operations"), link.batch(atomic=True) as batch:
            for address in range(100):
                batch.write_masked(address, 1, 1)
    else:
        with (
            pytest.raises(DeviceMismatch, match="lists of the framed protocol"),
            link.batch(atomic=True) as batch,
        ):
            batch.add(0x10, 5)
            batch.read(0x10)
    for wrong in ((0x100, 0), (0x10, 1 << 32)):
        with pytest.raises(ValueRangeError), link.batch() as batch:
            batch.write(0x20, 77)
            batch.write(*wrong)
    assert link.board.registers[0x20] != 77, "nothing was sent"


def test_a_fifo_is_taken_from_once(link: Link) -> None:
    for word in range(10):
        link.board.registers[FIFO] = word
    with link.batch() as batch:
        taken = batch.read_fifo(FIFO, 3)
        left = batch.read(FIFO + 1)
    assert [word.value for word in taken] == [0, 1, 2]
    assert left.value == 7


def test_a_bus_error_ends_it_and_says_where() -> None:
    line = Line(0)
    line.calm = True
    line.device.bus.bad[0x30] = 1
    with Link(line.url) as link:
        with pytest.raises(BusError) as caught, link.batch() as batch:
            batch.write(0x2F, 1)
            batch.add(0x30, 1)
            batch.write(0x31, 1)
        assert caught.value.address == 0x30
        assert (line.device.bus.words[0x2F], line.device.bus.words.get(0x31)) == (1, None)
