# SPDX-License-Identifier: BSD-3-Clause
"""Commits on gateware that swaps without copying, TosNet and double buffer."""

from __future__ import annotations

import asyncio
import threading
from types import ModuleType
from typing import Any

import pytest
from effort import many
from hypothesis import given, settings
from hypothesis import strategies as st

from unitylink.errors import (
    AccessRefused,
    DeviceMismatch,
    LinkTimeout,
    NetworkError,
    OutcomeUnknown,
    ValueRangeError,
)
from unitylink.layer3_hardware import DoubleBufferProxy, TosNetProxy


def tosnet(fake: ModuleType, **options: Any) -> tuple[Any, Any, TosNetProxy]:
    model = fake.TosNetModel(**options)
    link = fake.FakeLink(model, base=0x800)
    return model, link, TosNetProxy(link, 0x800)


def test_a_naive_writer_falls_into_the_first_hazard(fake: ModuleType) -> None:
    model = fake.TosNetModel(accesses_per_cycle=1)
    link = fake.FakeLink(model)
    for address, word in ((0x8C, 1), (0x8D, 2)):
        link.write(address, word)
        link.write(0x400, 1)
        model.strobe()
    assert model.outputs[0].get(0x8C, 0) == 0, "the model must have the hazard the proxy is tested against"


def test_a_naive_writer_falls_into_the_second_hazard(fake: ModuleType) -> None:
    model = fake.TosNetModel(accesses_per_cycle=0)
    link = fake.FakeLink(model)
    link.write(0x8C, 1)
    link.write(0x400, 1)
    link.write(0x8D, 2)
    assert model.aborted and not model.pending


def test_no_word_falls_back(fake: ModuleType) -> None:
    model, _, network = tosnet(fake)
    network.write(0x8C, 1)
    network.write(0x8D, 2)
    network.write(0x8D, 3)
    assert model.outputs[0] == {0x8C: 1, 0x8D: 3}
    assert not model.aborted


def test_a_refusal_names_all_that_a_commit_writes(fake: ModuleType, monkeypatch: pytest.MonkeyPatch) -> None:
    _, link, network = tosnet(fake)
    network.declare_outputs([0x84], "j2.goal")

    def refuse(*_: object, **__: object) -> None:
        raise AccessRefused("this is not allowed", address=0x884)

    monkeypatch.setattr(link, "write_many", refuse)
    with pytest.raises(AccessRefused, match=r"needs the scope `write` of each: j2\.goal, 0x0880$") as refused:
        network.write(0x80, 1)
    assert refused.value.address == 0x884


@settings(max_examples=many(60), deadline=None)
@given(
    bursts=st.lists(
        st.dictionaries(st.integers(0x80, 0x86), st.integers(0, 99), min_size=1, max_size=3), max_size=12
    ),
    pace=st.integers(1, 7),
)
def test_outputs_are_always_what_was_written_last(
    fake: ModuleType, bursts: list[dict[int, int]], pace: int
) -> None:
    model, _, network = tosnet(fake, accesses_per_cycle=pace)
    expected: dict[int, int] = {}
    for burst in bursts:
        expected |= burst
        network.write_many(burst.keys(), burst.values())
        assert model.outputs[0] == expected
        assert not model.aborted
    assert len(model.history) == len(bursts)


def test_a_running_robot_does_not_jump(fake: ModuleType) -> None:
    model, _, network = tosnet(fake)
    model.outputs[0].update({0x8C: 700, 0x8D: 800})
    network.declare_outputs([0x8C, 0x8D, 0x8E])
    network.write(0x8E, 5)
    assert model.outputs[0] == {0x8C: 700, 0x8D: 800, 0x8E: 5}
    network.write(0x8E, 6)
    assert model.outputs[0] == {0x8C: 700, 0x8D: 800, 0x8E: 6}


def test_a_batch_is_one_commit(fake: ModuleType) -> None:
    model, link, network = tosnet(fake)
    with network.batch():
        network.write(0x8C, 1)
        with network.batch():
            network.node(2).register(1).inputs[1] = 2
        assert not link.log
    assert model.history == [{0x8C: 1, 0x8D: 2}]


def test_a_batch_that_raises_sends_nothing(fake: ModuleType) -> None:
    _, link, network = tosnet(fake)
    with pytest.raises(KeyError), network.batch():
        network.write(0x8C, 1)
        raise KeyError
    assert not link.log
    network.write(0x8D, 2)
    assert network.outputs == {0x8D: 2}


def test_threads_do_not_mix_their_bursts(fake: ModuleType) -> None:
    model, _, network = tosnet(fake, accesses_per_cycle=3)

    def work(first: int) -> None:
        for number in range(20):
            network.write_many([first, first + 1], [number, number])

    threads = [threading.Thread(target=work, args=(0x80 + 2 * n,)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not model.aborted
    assert len(model.history) == 80
    for outputs in model.history:
        for first in (0x80, 0x82, 0x84, 0x86):
            assert outputs.get(first) == outputs.get(first + 1)


def test_async_writes_commit(fake: ModuleType) -> None:
    model, _, network = tosnet(fake)

    async def main() -> None:
        await asyncio.gather(*(network.write_async(0x80 + n, n) for n in range(4)))

    asyncio.run(main())
    assert model.outputs[0] == {0x80: 0, 0x81: 1, 0x82: 2, 0x83: 3}


def test_async_writes_inside_a_batch_join_it(fake: ModuleType) -> None:
    model, _, network = tosnet(fake)

    async def main() -> None:
        with network.batch():
            await network.write_async(0x80, 1)
            await network.write_many_async([0x81], [2])

    asyncio.run(main())
    assert model.history == [{0x80: 1, 0x81: 2}]


def test_a_lost_commit_reply_is_explained_and_not_repeated(fake: ModuleType) -> None:
    model, link, network = tosnet(fake)
    link.lose_write_reply = {0xC00}
    with pytest.raises(OutcomeUnknown, match=r"commit of 1 words at 0x0c00 .* not repeated"):
        network.write(0x8C, 1)
    assert [entry for entry in link.log if entry[:2] == ("W", 0xC00)] == [("W", 0xC00, 1)]
    assert ("W", 0xC00, False) in link.repeats
    assert ("W", 0x88C, True) in link.repeats
    link.lose_write_reply = set()
    network.commit()
    assert model.outputs[0] == {0x8C: 1}


def test_a_failed_burst_leaves_the_shadow(fake: ModuleType) -> None:
    model, link, network = tosnet(fake)
    network.write(0x8C, 1)
    link.fail = {0x88D: LinkTimeout("silent")}
    with pytest.raises(LinkTimeout):
        network.write_many([0x8C, 0x8D], [7, 8])
    link.fail = {}
    network.write(0x8E, 3)
    assert model.outputs[0] | {0x8D: 0} == {0x8C: 1, 0x8D: 0, 0x8E: 3}


def test_offline_and_halted_are_named(fake: ModuleType) -> None:
    model, _, network = tosnet(fake)
    model.online = False
    with pytest.raises(NetworkError, match="offline"):
        network.write(0x8C, 1)
    model.online, model.halted = True, True
    with pytest.raises(NetworkError, match="halted until its reset"):
        network.write(0x8C, 1)
    assert not model.outputs[1], "no word may be written to a network that is down"


def test_a_network_that_does_not_cycle_times_out(fake: ModuleType) -> None:
    _, _, network = tosnet(fake, accesses_per_cycle=0)
    with pytest.raises(LinkTimeout, match=r"still pending after .* does not cycle"):
        network.write(0x8C, 1, timeout_s=0.0)


def test_an_aborted_commit_is_reported(fake: ModuleType) -> None:
    model, link, network = tosnet(fake, accesses_per_cycle=0)
    write = link.write

    def intruder(address: int, value: int, **options: Any) -> None:
        write(address, value, **options)
        if address == 0xC00:
            model.write(0x99, 1)

    link.write = intruder
    with pytest.raises(NetworkError, match=r"aborted"):
        network.write(0x8C, 1)


@pytest.mark.parametrize(("address", "word"), [(0x400, 1), (0x602, 1), (-1, 1), (0x8C, -1), (0x8C, 1 << 32)])
def test_nothing_wrong_is_sent(fake: ModuleType, address: int, word: int) -> None:
    _, link, network = tosnet(fake)
    with pytest.raises(ValueRangeError):
        network.write_many([0x80, address], [1, word])
    assert not link.log


@given(
    bursts=st.lists(
        st.dictionaries(st.integers(0, 5), st.integers(0, 99), min_size=1, max_size=3), max_size=9
    )
)
def test_double_buffer_has_no_memory_of_two_commits_ago(
    fake: ModuleType, bursts: list[dict[int, int]]
) -> None:
    model = fake.DoubleBufferModel(6)
    proxy = DoubleBufferProxy(fake.FakeLink(model, base=0x20), 0x20, size=6)
    expected = [0] * 6
    for burst in bursts:
        proxy.write_many(burst.keys(), burst.values())
        for address, word in burst.items():
            expected[address] = word
        assert model.banks[0] == expected
    assert proxy.commits() == len(bursts)


def test_double_buffer_commits_by_itself_only(fake: ModuleType) -> None:
    proxy = DoubleBufferProxy(fake.FakeLink(fake.DoubleBufferModel(4)), size=4)
    with pytest.raises(ValueRangeError, match=r"commit\(\) commits"):
        proxy.write(4, 1)


def test_an_inner_batch_that_raises_takes_back_its_own_writes(fake: ModuleType) -> None:
    model = fake.TosNetModel()
    proxy = TosNetProxy(fake.FakeLink(model))
    with proxy.batch():
        proxy.write(0x84, 1)
        with pytest.raises(KeyError), proxy.batch():
            proxy.write(0x84, 9)
            proxy.write(0x85, 9)
            raise KeyError
        proxy.write(0x86, 3)
    assert model.history == [{0x84: 1, 0x86: 3}]


def test_tosnet_needs_its_word_width(fake: ModuleType) -> None:
    link = fake.FakeLink(configuration=fake.Configuration(data_bytes=2))
    with pytest.raises(DeviceMismatch, match="words of 16 bits, a TosNet module of 32"):
        TosNetProxy(link)
