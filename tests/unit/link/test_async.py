# SPDX-License-Identifier: BSD-3-Clause
"""The asyncio side of a link."""

from __future__ import annotations

import asyncio
import contextlib
from typing import Any

import pytest

from unitylink import BusError, Link, LinkClosed, ValueRangeError


def test_requests(link: Link, device: Any) -> None:
    async def main() -> None:
        values = await asyncio.gather(*(link.read_async(address) for address in range(50)))
        assert values == [device.memory[address] for address in range(50)]
        await link.write_async(3, 7)
        await link.write_many_async([4, 5], [8, 9], checked=True)
        assert (await link.read_many_async([3, 4, 5], atomic=True)).tolist() == [7, 8, 9]
        assert (await link.read_many_async([])).tolist() == []
        device.silent = {9}
        with pytest.raises(BusError, match="0x09"):
            await link.read_async(9)
        with pytest.raises(ValueRangeError):
            await link.read_async(256)
        device.silent = set()
        task = asyncio.ensure_future(link.read_async(1))
        task.cancel()
        assert await link.read_async(2) == device.memory[2]

    asyncio.run(main())
    assert link.read(3) == 7
    asyncio.run(main())


def test_a_cancelled_request_holds_up_nobody(link: Link, device: Any) -> None:
    async def main() -> None:
        device.intercept = lambda command, data: b"" if command == "R" and data[0] == 1 else None
        stuck = asyncio.ensure_future(link.read_async(1, timeout_s=3600))
        write = asyncio.ensure_future(link.write_async(3, 7))
        await asyncio.sleep(0)
        stuck.cancel()
        write.cancel()
        assert await asyncio.wait_for(link.read_async(2, timeout_s=1), 30) == device.memory[2]
        assert "W" not in device.log  # the write had not been sent

    asyncio.run(main())


def test_publishes(link: Link, device: Any) -> None:
    async def main() -> list[tuple[int, ...]]:
        got = []
        with link.subscribe([1, 2], divisor=10) as subscription:
            device.publish(subscription.group)
            async for _, words in subscription:
                got.append(words)
                if len(got) == 3:
                    break
                device.publish(subscription.group)
        return got

    assert asyncio.run(main()) == [(device.memory[1], device.memory[2])] * 3


def test_closing_a_subscription_ends_its_iteration(link: Link, device: Any) -> None:
    async def main() -> None:
        subscription = link.subscribe([1], divisor=10)

        async def listen() -> None:
            async for _ in subscription:
                raise AssertionError("nothing was published")

        listener = asyncio.ensure_future(listen())
        await asyncio.sleep(0)
        subscription.close()
        await asyncio.wait_for(listener, 10)
        pending = asyncio.ensure_future(link.read_async(1))
        await asyncio.sleep(0)
        link.close()
        with contextlib.suppress(LinkClosed):  # it may already have been answered
            await pending

    asyncio.run(main())


def test_closing_ends_what_is_awaited(link: Link, device: Any) -> None:
    async def main() -> None:
        subscription = link.subscribe([1], divisor=10)

        async def listen() -> None:
            async for _ in subscription:
                raise AssertionError("nothing was published")

        listener = asyncio.ensure_future(listen())
        device.intercept = lambda command, data: b""
        reader = asyncio.ensure_future(link.read_async(1, timeout_s=60))
        await asyncio.sleep(0)
        device.unplug()
        with pytest.raises(LinkClosed):
            await reader
        with pytest.raises(LinkClosed):
            await listener

    asyncio.run(main())
