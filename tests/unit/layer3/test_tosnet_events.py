# SPDX-License-Identifier: BSD-3-Clause
"""What the proxy of a TosNet network tells about cuts, halts and nodes that leave, on the twin."""

from __future__ import annotations

import logging
import queue
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import pytest

from unitylink import Link
from unitylink.errors import NetworkError, NetworkHalted, NetworkOffline, NodeLost, ValueRangeError
from unitylink.layer3_hardware import NetworkEvent, NetworkWatch, TosNetProxy
from unitylink.simulate import Board, BoardConfiguration, TosnetConfiguration, TosnetNode


@contextmanager
def network(max_skipped_writes: int = 0, rings: int = 1) -> Iterator[tuple[Board, TosNetProxy]]:
    nodes = (TosnetNode(2), TosnetNode(5, registers=0b11), TosnetNode(7))
    tosnet = TosnetConfiguration(
        nodes=nodes, cycle_s=200e-6, max_skipped_writes=max_skipped_writes, rings=rings
    )
    configuration = BoardConfiguration(address_bits=11, tosnet=tosnet)
    with Board(configuration=configuration) as board, Link(f"{board.url}?timeout=10") as link:
        yield board, TosNetProxy(link)


def seen(watch: NetworkWatch) -> list[tuple[str, int | None, type | None]]:
    """Return kind, node, and class of the error of each new event."""
    return [(one.kind, one.node, type(one.error) if one.error else None) for one in watch.look()]


def test_a_cut_and_its_end_are_told_once() -> None:
    with network() as (board, proxy):
        watch = proxy.watch()
        assert seen(watch) == []
        board.set_online(False)
        assert seen(watch) == [("offline", None, NetworkOffline)]
        assert seen(watch) == []
        with pytest.raises(NetworkOffline, match="is offline"):
            proxy.write(0x84, 1)
        board.set_online(True)
        assert seen(watch) == [("online", None, None)]
        assert seen(watch) == []


def test_one_of_two_rings_is_told_and_the_network_goes_on() -> None:
    with network(rings=2) as (board, proxy):
        watch = proxy.watch()
        assert seen(watch) == []
        board.set_ring(1, False)
        assert seen(watch) == [("ring_lost", 1, NetworkError)]
        assert "ring 1 down" in str(proxy.status()) and proxy.status().online
        proxy.write(0x84, 1)
        resets = proxy.counters().resets
        board.set_ring(0, False)
        assert seen(watch) == [("offline", None, NetworkOffline)]
        board.set_ring(0, True)
        assert seen(watch) == [("online", None, None)]
        board.set_ring(1, True)
        assert seen(watch) == [("ring_back", 1, None)]
        assert proxy.counters().resets == resets + 1
        board.set_online(False)
        board.set_online(True)
        assert seen(watch) == [("online", None, None)]
        with pytest.raises(ValueRangeError, match="ring 2"):
            board.set_ring(2, False)


def test_a_network_has_one_ring_if_nobody_says_more() -> None:
    with network() as (board, proxy):
        with pytest.raises(ValueRangeError, match="no TosNet with such a ring; see RINGS"):
            board.set_ring(1, False)
        board.set_ring(0, False)
        assert not proxy.status().online and proxy.status().rings_down == ()


def test_a_network_that_is_down_at_first_is_told() -> None:
    with network() as (board, proxy):
        board.set_online(False)
        watch = proxy.watch([9])
        assert seen(watch) == [("offline", None, NetworkOffline)]
        board.set_online(True)
        assert seen(watch) == [("online", None, None), ("node_lost", 9, NodeLost)]


def test_a_cut_between_two_looks_is_told() -> None:
    with network() as (board, proxy):
        watch = proxy.watch()
        assert seen(watch) == []
        board.set_online(False)
        board.set_online(True)
        assert seen(watch) == [("online", None, None)]


def test_a_node_leaves_and_comes_back() -> None:
    with network() as (board, proxy):
        watch = proxy.watch()
        assert seen(watch) == []
        board.registers[0x140] = 8
        while proxy.read(0x140) != 8:
            pass  # one network cycle
        board.set_node(5, False)
        _, event = watch.look()
        assert (event.kind, event.node, event.text) == (
            "node_lost",
            5,
            "node 5 is not in the ring; see to its power and its fibres",
        )
        assert isinstance(event.error, NodeLost) and event.error.nodes == (5,)
        assert [(n.node_id, n.ring_address) for n in proxy.nodes()] == [(1, 0), (2, 1), (7, 2)]
        board.registers[0x140], board.registers[0x80] = 9, 9
        while proxy.read(0x80) != 9:
            pass
        assert proxy.read(0x140) == 8, "its words do not change"
        board.set_node(5, True)
        assert seen(watch) == [("online", None, None), ("node_back", 5, None)]
        while proxy.read(0x140) != 9:
            pass


def test_nodes_that_should_be_there_are_missed_at_once() -> None:
    with network() as (_, proxy):
        proxy.check_nodes(2, 5, 7)
        with pytest.raises(NodeLost, match="nodes 3, 9 are not in the ring") as raised:
            proxy.check_nodes(9, 5, 3)
        assert raised.value.nodes == (3, 9)
        watch = proxy.watch([2, 9])
        assert seen(watch) == [("node_lost", 9, NodeLost)]
        assert seen(watch) == []


def test_a_halt_is_told() -> None:
    with network(max_skipped_writes=3) as (_, proxy):
        watch = proxy.watch()
        found = seen(watch)
        while not found:
            found = seen(watch)
        assert found == [("halted", None, NetworkHalted)]
        with pytest.raises(NetworkHalted, match="halted until its reset"):
            proxy.write(0x84, 1)


def test_events_come_by_themselves(caplog: pytest.LogCaptureFixture) -> None:
    heard: queue.Queue[NetworkEvent] = queue.Queue()

    def hear(event: NetworkEvent) -> None:
        heard.put(event)
        raise RuntimeError("a mistake in a callback")

    with network() as (board, proxy), caplog.at_level(logging.CRITICAL, "unitylink.tosnet"):
        end = proxy.on_event(hear, nodes=[1, 2, 5, 7], period_s=0.001)
        board.set_online(False)
        assert heard.get(timeout=30).kind == "offline"
        board.set_online(True)
        assert heard.get(timeout=30).kind == "online", "the events go on after a mistake"
        end()
        board.set_online(False)
        end()
        assert heard.empty()


@pytest.mark.parametrize("period_s", [0.001, 1e300])
def test_the_events_end_with_the_link(period_s: float) -> None:
    with network() as (_, proxy):
        end = proxy.on_event(print, period_s=period_s)
    end()  # its thread has ended, or does so now


@pytest.mark.parametrize("wrong", [{"callback": 3}, {"nodes": "ab"}, {"period_s": -1}])
def test_wrong_arguments_are_named(wrong: dict[str, Any]) -> None:
    with network() as (_, proxy), pytest.raises(ValueRangeError, match="tosnet: "):
        proxy.on_event(**{"callback": print, **wrong})


@pytest.mark.parametrize("node", [1, 3, 16, -1])
def test_only_a_node_of_the_ring_can_leave(node: int) -> None:
    with network() as (board, _), pytest.raises(ValueRangeError, match="no TosNet with such a node"):
        board.set_node(node, False)
