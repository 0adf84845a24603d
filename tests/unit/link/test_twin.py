# SPDX-License-Identifier: BSD-3-Clause
"""Link on the twin, over every endpoint that it has."""

from __future__ import annotations

import asyncio
import contextlib
import socket
import threading
from types import ModuleType

import numpy as np
import pytest

from unitylink import (
    BusError,
    DeviceMismatch,
    LinkBusy,
    LinkClosed,
    ProtocolError,
    ValueRangeError,
    connect,
)
from unitylink.simulate import Board, BoardConfiguration


def options(url: str, text: str) -> str:
    return url + ("&" if "?" in url else "?") + text


@pytest.mark.parametrize("endpoint", ["fd", "pty", "tcp", "udp"])
def test_requests_and_publishes(endpoint: str) -> None:
    with Board(endpoint=endpoint) as board, connect(options(board.url, "fifo=1024&timeout=2")) as link:
        addresses = np.arange(64)
        link.write_many(addresses, addresses * 3, checked=True)
        assert link.read_many(addresses).tolist() == (addresses * 3).tolist()
        assert link.read_each(addresses, checked=True).tolist() == (addresses * 3).tolist()
        board.registers[5] = 0xCAFE
        assert link.read(5) == 0xCAFE
        with link.subscribe([5, 6], divisor=1) as subscription:
            assert subscription.wait(10)
            times, values = subscription.drain()
            assert values.tolist() == [[0xCAFE, 18]] * len(times)
        assert link.statistics().retries == 0


def test_many_callbacks_at_once() -> None:
    with Board() as board, connect(options(board.url, "timeout=2")) as link:
        counts = [0, 0]
        enough = threading.Event()

        def counting(which: int) -> None:
            counts[which] += 1
            if min(counts) >= 20:
                enough.set()

        for which in range(2):
            subscription = link.subscribe([which], divisor=1)
            subscription.on_publish(lambda time_s, words, which=which: counting(which))  # type: ignore[misc]
        assert enough.wait(20)
        assert link.read(0) == 0  # requests work meanwhile


def test_asyncio_over_tcp() -> None:
    async def main(url: str) -> int:
        with connect(url) as link:
            await link.write_many_async(range(100), range(100))
            words = await asyncio.gather(*(link.read_async(address) for address in range(100)))
            assert words == list(range(100))
            seen = 0
            with link.subscribe([1], divisor=1) as subscription:
                async for _, (word,) in subscription:
                    assert word == 1
                    seen += 1
                    if seen == 10:
                        return seen
        return 0

    with Board(endpoint="tcp") as board:
        assert asyncio.run(main(options(board.url, "fifo=1024&timeout=2"))) == 10


def test_a_board_serves_one_program() -> None:
    with Board(endpoint="tcp") as board, connect(board.url), pytest.raises(LinkBusy, match="another program"):
        connect(board.url)
    with Board(endpoint="pty") as board, connect(board.url), pytest.raises(LinkBusy, match="another program"):
        connect(board.url)


@pytest.mark.parametrize("endpoint", ["pty", "tcp"])
def test_a_board_that_goes_away(endpoint: str) -> None:
    with Board(endpoint=endpoint) as board:
        link = connect(options(board.url, "timeout=20"))
    with pytest.raises(LinkClosed):
        link.read(1)
    link.close()
    with Board(endpoint=endpoint) as board, connect(board.url) as link:
        assert link.read(1) == 0


@pytest.mark.parametrize("data_bits", [8, 16, 24])
def test_narrow_words_are_written_by_corrected_gateware_only(data_bits: int, fake: ModuleType) -> None:
    narrow = BoardConfiguration(data_bits=data_bits)
    highest = (1 << data_bits) - 1
    with Board(configuration=narrow) as board, connect(board.url) as link:
        assert link.configuration.data_bits == data_bits
        link.write(3, highest)
        assert board.registers[3] == link.read(3) == highest
        link.write_many([4, 5], [1, highest - 1], checked=True)
        assert link.read_many([4, 5]).tolist() == [1, highest - 1]
        with pytest.raises(ValueRangeError, match=f"{data_bits}-bit words"):
            link.write(3, highest + 1)
    with (
        Board(configuration=narrow) as board,
        connect(options(board.url, "gateware=2012")) as link,
        pytest.raises(DeviceMismatch, match=f"2012 gateware with {data_bits}-bit words: it writes 0"),
    ):
        link.write(3, 1)
    old = fake.FakeDevice(
        configuration=f"01,{data_bits // 8:02x},20,02,03e8,02,10,02"
    )  # answers "$" as in 2012
    with connect(old.url()) as link:
        for _ in range(2):
            with pytest.raises(DeviceMismatch, match="2012 gateware"):
                link.write(3, 1)
    assert old.log.count("") == 1  # asked once
    assert "W" not in old.log
    old.close()


def test_the_error_explains_what_a_bus_timeout_may_do_on_2012_gateware() -> None:
    configuration = BoardConfiguration(
        protocol="classic", published_2012=True, silent_ranges=((0, 0), (0xF0, 0xFF))
    )
    with Board(configuration=configuration) as board, connect(options(board.url, "timeout=5")) as link:
        board.registers[5] = 9
        with pytest.raises(BusError, match="will write 0 to the address that its next read or write names"):
            link.write(0xF5, 1)
        with pytest.raises(ProtocolError, match="after a bus timeout"):
            link.read(5, repeat=False)
        assert board.registers[5] == 0, "and it did"
        link.write(5, 9)  # this is the remedy that the error names
        with pytest.raises(BusError, match="2012") as refused:
            link.write(0xF5, 1)
        assert refused.value.address == 0xF5


@pytest.mark.parametrize(
    "text", ["fifo=1", "fifo=1&window=1&crc=1", "fifo=16777216&window=65536", "fifo=1,64"]
)
def test_the_smallest_and_the_largest_credit(text: str) -> None:
    with Board() as board, connect(options(board.url, text + "&timeout=5&protocol=classic")) as link:
        addresses = list(range(200))
        link.write_many(addresses, addresses)
        assert link.read_many(addresses).tolist() == addresses
        assert link.read_each(addresses).tolist() == addresses
        assert link.statistics().retries == 0


@pytest.mark.parametrize("publish_mode", [1, 2])
def test_connecting_to_a_board_that_another_program_left_publishing_in_mid_message(publish_mode: int) -> None:
    busy = BoardConfiguration(base_hz=100_000, groups=4, publish_mode=publish_mode)
    with Board(configuration=busy, endpoint="tcp") as board:
        host, port = board.url.removeprefix("tcp://").split(":")
        with socket.create_connection((host, int(port))) as other:
            other.sendall(b"#WSA:030101\n#WSR:030001\n#WSA:0203010203\n#WSR:020002\n#WIC:000f\n#EPC\n")
            assert other.recv(100)
            other.sendall(b"#W:05DEAD")
        link = None
        while link is None:  # the board notices only a moment later that the other client has left
            with contextlib.suppress(LinkBusy):
                link = connect(options(board.url, "fifo=1024&timeout=5&protocol=classic"))
        with link:
            link.write(5, 7)
            assert link.read(5) == 7
            with link.subscribe([5], divisor=10) as subscription:
                unclaimed = link.statistics().unclaimed_publishes
                assert unclaimed > 0
                for _ in range(3):
                    assert subscription.wait(10)
                    assert set(subscription.drain()[1].ravel().tolist()) == {7}
                assert link.statistics().unclaimed_publishes == unclaimed
