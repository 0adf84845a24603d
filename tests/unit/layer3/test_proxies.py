# SPDX-License-Identifier: BSD-3-Clause
"""Memory, FIFO, and the parts of TosNet beside its memory."""

from __future__ import annotations

import asyncio
from types import ModuleType

import pytest

from unitylink.errors import BusError, DeviceMismatch, LinkTimeout, ValueRangeError
from unitylink.gateware import gateware_folder
from unitylink.layer3_hardware import FifoProxy, FifoStatus, MemoryProxy, NetworkNode, TosNetProxy


def test_memory_is_relative_and_repeatable(fake: ModuleType) -> None:
    link = fake.FakeLink()
    memory = MemoryProxy(link, 0x40, words=16)
    memory.write(2, 7)
    memory.write_many([3, 4], [8, 9])
    assert link.bus.words == {0x42: 7, 0x43: 8, 0x44: 9}
    assert memory.read(2) == memory.reader(2)() == 7
    assert memory.read_many([2, 4], atomic=True).tolist() == [7, 9]
    assert all(repeat for _, _, repeat in link.repeats)
    assert memory.subscribe([2, 3], divisor=10).addresses == (0x42, 0x43)


def test_memory_async(fake: ModuleType) -> None:
    memory = MemoryProxy(fake.FakeLink(), 0x40)

    async def main() -> list[int]:
        await memory.write_async(1, 5)
        await memory.write_many_async([2, 3], [6, 7])
        return [await memory.read_async(1), *(await memory.read_many_async([2, 3])).tolist()]

    assert asyncio.run(main()) == [5, 6, 7]


def test_addresses_outside_are_named(fake: ModuleType) -> None:
    memory = MemoryProxy(fake.FakeLink(), 0x40, words=16)
    for wrong in (-1, 16):
        with pytest.raises(ValueRangeError, match="no word"):
            memory.read(wrong)
    with pytest.raises(ValueRangeError, match="2 addresses and 1 values"):
        memory.write_many([1, 2], [3])


def test_fifo_pops_once_and_in_order(fake: ModuleType) -> None:
    model = fake.FifoModel(4)
    link = fake.FakeLink(model, base=0x200)
    fifo = FifoProxy(link, 0x200)
    model.to_pc = [1, 2, 3]
    assert fifo.status() == FifoStatus(count=3, space=4)
    assert fifo.pop() == 1
    assert fifo.pop_many(10).tolist() == [2, 3]
    assert fifo.pop_many(10).tolist() == []
    assert fifo.status().empty and not fifo.status().full
    assert not any(repeat for kind, address, repeat in link.repeats if address == 0x200)


def test_fifo_says_what_to_do(fake: ModuleType) -> None:
    fifo = FifoProxy(fake.FakeLink(fake.FifoModel(2)))
    with pytest.raises(BusError, match="nothing to pop"):
        fifo.pop()
    with pytest.raises(ValueRangeError, match="3 words do not fit, it has room for 2"):
        fifo.push_many([1, 2, 3])
    fifo.push_many([1, 2])
    with pytest.raises(BusError, match="no room"):
        fifo.push(3)
    assert fifo.link.bus.from_pc == [1, 2]  # type: ignore[attr-defined]
    with pytest.raises(ValueRangeError):
        fifo.pop_many(-1)


def test_a_register_with_a_larger_number_than_a_fifo_holds_is_refused(fake: ModuleType) -> None:
    """Some other register may hold a large number. Popping so many words would take hours."""
    link = fake.FakeLink()
    fifo = FifoProxy(link, 0x40)
    most = "range 2 to 2 ** 16 := 16;"
    assert most in (gateware_folder() / "bus" / "fifo_slave.vhd").read_text("utf-8")
    link.bus.words = {0x41: 2**16 + 1, 0x42: 2**32 - 1}
    for act in (lambda: fifo.pop_many(10**9), lambda: fifo.push_many([1])):
        with pytest.raises(DeviceMismatch, match=r"no FIFO at 0x0040: the word at 0x004[12] is "):
            act()
    link.bus.words[0x41] = 2**16
    assert len(fifo.pop_many(3)) == 3


def test_tosnet_node_addressing(fake: ModuleType) -> None:
    model = fake.TosNetModel()
    network = TosNetProxy(fake.FakeLink(model))
    register = network.node(2).register(1)
    assert register.outputs.address(0) == 0x88  # Fig. 1: cpos of joint 1
    assert register.inputs.address(0) == 0x8C  # Fig. 1: pos_sp of joint 1
    model.inputs[0x8A] = 44
    assert register.outputs[2] == 44
    assert list(register.outputs) == [0, 0, 44, 0]
    register.inputs[3] = 9
    assert model.outputs[0] == {0x8F: 9}
    for wrong in (lambda: network.node(16), lambda: network.node(1).register(8), lambda: register.outputs[4]):
        with pytest.raises(ValueRangeError):
            wrong()


def test_tosnet_status_counters_and_nodes(fake: ModuleType) -> None:
    network = TosNetProxy(fake.FakeLink(fake.TosNetModel()))
    status = network.status()
    assert (status.online, status.master, status.node_id, status.commit_pending) == (True, True, 1, False)
    assert (network.counters().packets, network.counters().resets, network.counters().errors) == (1, 2, 3)
    assert network.nodes() == (NetworkNode(1, 0, (0,)), NetworkNode(2, 1, (0, 1, 2)))


def test_tosnet_async_channel(fake: ModuleType) -> None:
    model = fake.TosNetModel()
    network = TosNetProxy(fake.FakeLink(model))
    network.async_send(3, b"hello!")
    assert model.sent == [(3 << 4 | 3, 0x68656C6C), (1 << 4 | 3, 0x6F210000)]
    model.received = [(2, b"abcd"), (2, b"e"), (4, b"xy")]
    assert network.async_receive() == [(2, b"abcde"), (4, b"xy")]
    assert network.async_receive() == []
    with pytest.raises(ValueRangeError):
        network.async_send(16, b"x")
    with pytest.raises(LinkTimeout, match="24 bytes were taken before"):
        network.async_send(3, bytes(64), timeout_s=0.0)
