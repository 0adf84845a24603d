# SPDX-License-Identifier: BSD-3-Clause
"""Exchange groups: the words are named once. Then a few bytes write all outputs and read all inputs."""

from __future__ import annotations

import threading

import pytest
from reference.device import ReferenceDevice
from reference.line import Line
from reference.settings import Settings

from unitylink.errors import BusError, DeviceMismatch, ValueRangeError
from unitylink.layer2_message import Link
from unitylink.simulate import Board, BoardConfiguration


def test_only_data_travels_and_each_word_has_its_own_size() -> None:
    with Board() as board, Link(f"{board.url}?timeout=2") as link:
        board.registers[0x10], board.registers[0x11] = 0x12345678, 0xFFFF
        with link.exchange_group(writes=[0x20, (0x21, 1)], reads=[(0x10, 2), 0x11, 0x20]) as group:
            assert group.atomic
            before = link.statistics()
            assert group.exchange([0xA0B0C0D0, 7]).tolist() == [0x5678, 0xFFFF, 0xA0B0C0D0]
            after = link.statistics()
            assert after.requests == before.requests + 1
            # id and group, 5 bytes of data
            assert after.bytes_sent - before.bytes_sent == 1 + 1 + 3 + 5 + 3 + 1
            assert board.registers[0x21] == 7
            for words, trouble in (([1], "2 outputs"), ([1, 256], "1 bytes")):
                with pytest.raises(ValueRangeError, match=trouble):
                    group.exchange(words)
        with pytest.raises(ValueRangeError, match="closed"):
            group.exchange([1, 2])


def test_there_are_as_many_and_as_large_groups_as_the_device_has() -> None:
    with (
        Board(configuration=BoardConfiguration(exchanges=2, exchange_size=3)) as board,
        Link(f"{board.url}?timeout=2") as link,
    ):
        first, second = link.exchange_group(reads=[1]), link.exchange_group(writes=[2])
        with pytest.raises(DeviceMismatch, match="all 2 exchange groups"):
            link.exchange_group(reads=[3])
        first.close()
        third = link.exchange_group(writes=[3], reads=[2])
        second.exchange([5])
        assert third.exchange([9]).tolist() == [5]
        third.close()
        with pytest.raises(DeviceMismatch, match="of 4 words is too large: this gateware's hold 3"):
            link.exchange_group(reads=[1, 2, 3, 4])
        with pytest.raises(ValueRangeError, match="without words"):
            link.exchange_group()
        with pytest.raises(ValueRangeError, match=r"0x20.*1 to 4 bytes"):
            link.exchange_group(reads=[(0x20, 5)])
    with (
        Board(configuration=BoardConfiguration(exchanges=0)) as board,
        Link(f"{board.url}?timeout=2") as link,
        pytest.raises(DeviceMismatch, match="built without exchange groups"),
    ):
        link.exchange_group(reads=[1])


def test_on_a_classic_link_it_does_writes_and_reads_and_says_so() -> None:
    with (
        Board(configuration=BoardConfiguration(protocol="classic")) as board,
        Link(f"{board.url}?timeout=2") as link,
        link.exchange_group(writes=[(0x20, 2)], reads=[(0x20, 1), 0x10]) as group,
    ):
        board.registers[0x10] = 77
        assert not group.atomic
        assert group.exchange([0x1234]).tolist() == [0x34, 77]
        with pytest.raises(ValueRangeError):
            group.exchange([0x10000])


def test_it_is_defined_again_when_the_device_was_reset() -> None:
    line = Line(0)
    line.calm = True
    with Link(line.url) as link:
        group = link.exchange_group(writes=[0x20], reads=[0x20, 0x21])
        spare = link.exchange_group(reads=[0x20])
        spare.close()
        group.exchange([4])
        line.device = ReferenceDevice(Settings(window=8), line.device.bus)
        assert link.read(0x20) == 4
        assert group.exchange([6]).tolist() == [6, 0]
        assert link.statistics().sessions == 2


def test_a_bus_error_is_reported_and_the_group_stays_usable() -> None:
    line = Line(0)
    line.calm = True
    line.device.bus.bad[0x30] = 1
    with Link(line.url) as link:
        group = link.exchange_group(writes=[0x2F, 0x30], reads=[0x2F])
        with pytest.raises(BusError, match="exchange of group 0"):
            group.exchange([1, 2])
        del line.device.bus.bad[0x30]
        assert group.exchange([3, 4]).tolist() == [3]


def test_threads_may_share_one() -> None:
    with Board() as board, Link(f"{board.url}?timeout=5") as link:
        group = link.exchange_group(writes=[0x20, 0x21], reads=[0x20, 0x21])
        torn: list[list[int]] = []

        def work(base: int) -> None:
            for number in range(base, base + 100):
                words = group.exchange([number, number]).tolist()
                if words != [number, number]:
                    torn.append(words)

        threads = [threading.Thread(target=work, args=(base,)) for base in (0, 1000, 2000)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        assert not torn
