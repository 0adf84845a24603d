# SPDX-License-Identifier: BSD-3-Clause
"""The proxies on the twin of the gateware, over a real link."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from unitylink import Link
from unitylink.errors import BusError, LinkTimeout, NetworkError, ValueRangeError
from unitylink.layer3_hardware import DoubleBufferProxy, FifoProxy, MemoryProxy, TosNetProxy
from unitylink.simulate import (
    Board,
    BoardConfiguration,
    DoubleBufferConfiguration,
    FifoConfiguration,
    TosnetConfiguration,
    TosnetNode,
)

STATUS = 0x400
PENDING = 1


@contextmanager
def network(cycle_s: float = 200e-6) -> Iterator[tuple[Board, Link, TosNetProxy]]:
    tosnet = TosnetConfiguration(nodes=(TosnetNode(2), TosnetNode(5, registers=0b11)), cycle_s=cycle_s)
    configuration = BoardConfiguration(address_bits=11, tosnet=tosnet)
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=10") as link:
        yield board, link, TosNetProxy(link)


def naive_write(link: Link, address: int, word: int) -> None:
    """Do what a program does that does not know TosNet: write the word, commit, wait."""
    link.write(address, word)
    link.write(STATUS, 1)
    while link.read(STATUS) & PENDING:
        pass


def test_a_naive_writer_loses_its_word_two_commits_later() -> None:
    with network() as (board, link, _):
        naive_write(link, 0x84, 1)
        naive_write(link, 0x85, 2)
        assert board.registers[0x84] == 0, "the swap does not copy"


def test_a_naive_writer_aborts_its_commit() -> None:
    with network(cycle_s=20e-3) as (board, link, _):
        link.write(0x84, 1)
        link.write(STATUS, 1)
        link.write(0x85, 2)
        assert link.read(STATUS) >> 5 & 1, "a write while a commit is pending aborts it"
        assert board.registers[0x84] == 0


def test_the_proxy_falls_into_neither() -> None:
    with network(cycle_s=2e-3) as (board, _, proxy):
        for number in range(1, 9):
            proxy.write(0x84 + number % 4, number)
        assert [board.registers[0x84 + n] for n in range(4)] == [8, 5, 6, 7]
        assert not proxy.status().commit_aborted


def test_threads_and_tasks_share_one_network() -> None:
    with network() as (board, _, proxy):
        words = [2 << 6 | register << 3 | 4 | word for register in range(4) for word in range(4)]

        def work(address: int) -> None:
            for number in range(10):
                proxy.write(address, number)

        async def tasks() -> None:
            await asyncio.gather(*(proxy.write_async(address, 99) for address in words[8:]))

        threads = [threading.Thread(target=work, args=(address,)) for address in words[:8]]
        for thread in threads:
            thread.start()
        asyncio.run(tasks())
        for thread in threads:
            thread.join()
        assert [board.registers[address] for address in words] == [9] * 8 + [99] * 8


def test_a_second_program_takes_over_without_a_jump() -> None:
    with network() as (board, link, proxy):
        proxy.write_many([0x84, 0x85, 0x86], [700, 800, 900])
        proxy.write(0x86, 901)
        successor = TosNetProxy(link)  # it does not know what the first one wrote
        successor.declare_outputs([0x84, 0x85, 0x86])
        for number in (1, 2, 3):
            successor.write(0x87, number)
            assert [board.registers[0x84 + n] for n in range(4)] == [700, 800, 901, number]


def test_a_broken_network_is_named_and_recovers() -> None:
    with network() as (board, _, proxy):
        proxy.write(0x84, 1)
        board.set_online(False)
        with pytest.raises((NetworkError, LinkTimeout), match="offline"):
            proxy.write(0x84, 2)
        board.set_online(True)
        proxy.write(0x84, 3)
        assert board.registers[0x84] == 3
        assert proxy.counters().resets == 1


def test_status_and_nodes() -> None:
    with network() as (board, _, proxy):
        status = proxy.status()
        assert status.online and status.master and status.node_id == 1 and not status.commit_pending
        assert [node.node_id for node in proxy.nodes()] == [1, 2, 5]
        assert proxy.nodes()[2].registers == (0, 1)
        board.registers[0x80] = 42
        while proxy.node(2).register(0).outputs[0] != 42:
            pass  # one network cycle
        with pytest.raises(BusError):
            proxy.read(0x700 + 9)


def test_each_cycle_publishes_once_while_the_network_is_there() -> None:
    tosnet = TosnetConfiguration(nodes=(TosnetNode(2),), cycle_s=200e-6, event_group=1)
    configuration = BoardConfiguration(address_bits=11, edge_events=(1,), tosnet=tosnet)
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=10") as link:
        proxy = TosNetProxy(link)
        with link.subscribe([0x401, 0x80], on_event=True, group=1) as cycles:
            counts: list[int] = []
            while len(counts) < 40:
                assert cycles.wait(5.0)
                counts += cycles.drain()[1][:, 0].tolist()
            assert counts == list(range(counts[0], counts[0] + len(counts)))
            board.set_online(False)
            last = proxy.counters().packets
            while cycles.wait(0.05):
                counts += cycles.drain()[1][:, 0].tolist()
            assert counts[-1] == last, "no stale words are published"


def test_the_cycle_wants_an_edge_event_group() -> None:
    with pytest.raises(ValueRangeError, match="event_group of tosnet is 1; choose one of the board's"):
        Board(configuration=BoardConfiguration(tosnet=TosnetConfiguration(event_group=1)))


def test_async_channel() -> None:
    with network() as (board, _, proxy):
        proxy.async_send(2, b"hello, node")
        heard = b""
        while len(heard) < 11:
            proxy.status()  # a network cycle passes
            for node, data in board.registers.async_receive():
                assert node == 2
                heard += data
        assert heard == b"hello, node"
        assert proxy.async_receive() == []


def test_fifo_double_buffer_and_memory_side_by_side() -> None:
    configuration = BoardConfiguration(
        fifos=(FifoConfiguration(base=0x40, depth=8),),
        double_buffers=(DoubleBufferConfiguration(base=0x80, size=4),),
    )
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=10") as link:
        memory, fifo = MemoryProxy(link, 0x10), FifoProxy(link, 0x40)
        memory.write_many(range(4), [1, 2, 3, 4])
        assert [board.registers[0x10 + n] for n in range(4)] == [1, 2, 3, 4]
        for number in range(5):
            board.registers[0x40] = number
        assert fifo.status().count == 5
        assert fifo.pop() == 0
        assert fifo.pop_many(99).tolist() == [1, 2, 3, 4]
        with pytest.raises(BusError, match="nothing to pop"):
            fifo.pop()
        fifo.push_many([7, 8])
        assert [board.registers[0x40], board.registers[0x40]] == [7, 8]
        table = DoubleBufferProxy(link, 0x80, size=4)
        table.write(0, 1)
        table.write(1, 2)
        with table.batch():
            table.write(2, 3)
            table.write(3, 4)
        assert (
            table.read_many(range(4)).tolist()
            == [board.registers[0x80 + n] for n in range(4)]
            == [1, 2, 3, 4]
        )
        assert table.commits() == 3


def test_a_write_that_the_network_left_pending_says_that_it_comes_later() -> None:
    with network(cycle_s=5e-3) as (board, _, proxy):
        proxy.write(0x84, 1)
        board.set_online(False)
        proxy._settled = True  # as if the network broke between our look and our commit
        with pytest.raises(NetworkError, match="takes effect when it is back"):
            proxy.write(0x84, 2)
        board.set_online(True)
        proxy.write(0x85, 3)
        assert board.registers[0x84] == 2 and board.registers[0x85] == 3


def test_a_word_of_a_burst_that_failed_does_not_come_with_the_next() -> None:
    with network() as (board, _, proxy):
        proxy.write(0x84, 1)
        with pytest.raises(BusError):
            proxy.write_many((0x85, 0x80), (7, 7))  # 0x80 belongs to node 2, so the burst ends there
        proxy.declare_outputs([0x86])
        del proxy._outputs[0x80]
        proxy.write(0x86, 3)
        assert [board.registers[a] for a in (0x84, 0x85, 0x86)] == [1, 0, 3]


def test_a_fifo_publishes_its_words_by_itself() -> None:
    """There is no rate and no polling.

    Each word comes once, also the words that were there before the subscription.
    """
    fifo = FifoConfiguration(base=0x40, depth=64, event_group=3, remind_clocks=50_000)
    configuration = BoardConfiguration(groups=4, edge_events=(3,), fifos=(fifo,))
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=10") as link:
        board.registers[0x40] = 1
        board.registers[0x40] = 2
        with FifoProxy(link, 0x40).subscribe([0], on_event=True, group=3) as words:
            for number in range(3, 41):
                board.registers[0x40] = number
            heard: list[int] = []
            while len(heard) < 40:
                assert words.wait(5.0), f"only {heard} came"
                heard += words.drain()[1][:, 0].tolist()
            assert heard == list(range(1, 41))
        assert FifoProxy(link, 0x40).status().empty


def test_a_fifo_wants_an_edge_event_group() -> None:
    with pytest.raises(
        ValueRangeError, match="event_group is 1; choose one of the board's groups and list it"
    ):
        Board(configuration=BoardConfiguration(fifos=(FifoConfiguration(base=0x40, event_group=1),)))
