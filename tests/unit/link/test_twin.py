# SPDX-License-Identifier: BSD-3-Clause
"""Link against the twin, over every endpoint it has."""

from __future__ import annotations

import asyncio
import threading

import numpy as np
import pytest

from unitylink import DeviceMismatch, LinkBusy, LinkClosed, connect
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
        assert link.read(0) == 0  # requests go on beside it


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


def test_narrow_words() -> None:
    narrow = BoardConfiguration(data_bits=16)
    with Board(configuration=narrow) as board, connect(board.url) as link:
        assert link.configuration.data_bits == 16
        board.registers[3] = 0x1234
        assert link.read(3) == 0x1234
    with (
        Board(configuration=narrow) as board,
        connect(options(board.url, "gateware=2012")) as link,
        pytest.raises(DeviceMismatch, match="2012 gateware with 16-bit words: it writes 0"),
    ):
        link.write(3, 1)
