# SPDX-License-Identifier: BSD-3-Clause
"""Publishes that came before a subscription was closed reach the callback or can be drained.

After that, nothing more comes.
"""

from __future__ import annotations

import asyncio
import queue
import random
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from unitylink import Link, LinkClosed, connect
from unitylink.simulate import Board, BoardConfiguration

HOURS_S = 3600  # no request takes so long, even on a busy machine; pytest ends a test that hangs
SPEC = "public robot() { @count = 0x1: READ(PUBLISH(1,1)); }"


@pytest.fixture(params=["classic", "framed", "mapped", "sim"])
def any_link(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Link]:
    """Yield a link to each kind of device. All of them publish by themselves, at 1 kHz or slower."""
    if request.param == "mapped":
        (tmp_path / "registers").write_bytes(bytes(64))
        with connect(f"mmap:{tmp_path / 'registers'}") as link:
            yield link
    elif request.param == "sim":
        (tmp_path / "robot.ul").write_text(SPEC)
        with connect(f"sim:{tmp_path / 'robot.ul'}?timeout=2") as link:
            yield link
    else:
        board = Board(configuration=BoardConfiguration(protocol=request.param))
        with board, Link(f"{board.url}?timeout=2&protocol={request.param}") as link:
            yield link


def numbered(device: Any, subscription: Any, numbers: range) -> None:
    """Publish numbers. The test does not wait for them, so some may still be on their way."""
    for number in numbers:
        device.memory[subscription.addresses[0]] = number
        device.publish(subscription.group)


@pytest.mark.parametrize("seed", range(20))
def test_all_that_was_sent_before_is_there(link: Link, device: Any, seed: int) -> None:
    chosen = random.Random(seed)
    kept = link.subscribe([9], divisor=10) if chosen.random() < 0.5 else None
    for _ in range(10):
        subscription = link.subscribe([1], divisor=10)
        count = chosen.choice((0, 1, 2, 50, 700))
        got: list[int] = []

        def arrays(times: Any, words: Any, got: list[int] = got) -> bool:
            got += words[:, 0].tolist()
            return True

        if how := chosen.choice(("", "one", "many")):
            subscription.on_publish(
                lambda time_s, words, got=got: got.append(words[0]),  # type: ignore[misc]
                gather_s=chosen.choice((0.0, 60.0)),
                arrays=arrays if how == "many" else None,
            )
        numbered(device, subscription, range(count))
        subscription.close()
        if not how:
            link.subscribe([1], divisor=10).close()  # another subscription of the same group
            assert subscription.available == count
            assert count == 0 or subscription.wait(0)
            times, words = subscription.drain()
            assert words.shape == (count, 1) and sorted(times) == times.tolist()
            got += words[:, 0].tolist()
        assert got == list(range(count))
        assert subscription.available == subscription.lost == len(subscription.drain()[0]) == 0
        with pytest.raises(LinkClosed):
            subscription.wait(0)
    assert kept is None or kept.available == 0
    assert link.statistics().unclaimed_publishes == 0


@pytest.mark.parametrize("seed", range(3))
def test_on_every_kind_of_board(any_link: Link, seed: int) -> None:
    chosen = random.Random(seed)
    before = any_link.statistics().publishes
    total = 0
    for _ in range(4):
        counts: queue.SimpleQueue[int] = queue.SimpleQueue()
        called = [0]

        def call(time_s: float, words: tuple[int, ...], called: list[int] = called) -> None:
            called[0] += 1
            counts.put(called[0])  # noqa: B023  this round's

        with any_link.subscribe([0], divisor=1) as heard, any_link.subscribe([1], divisor=2) as read:
            heard.on_publish(call)
            enough = chosen.randrange(1, 20)
            while counts.get(timeout=20) < enough:
                pass
            assert read.wait(20)
            first, second = (heard, read) if chosen.random() < 0.5 else (read, heard)
            first.close()
            second.close()
            after = called[0]
            total += after + len(read.drain()[0])
        assert any_link.statistics().publishes - before == total
        assert heard.missing == read.missing == any_link.statistics().overruns == 0
        any_link.read(0)
        assert called[0] == after  # no more calls came


@pytest.mark.parametrize("what", ["itself", "another", "link"])
def test_publishes_left_by_a_closing_callback_can_be_drained(link: Link, device: Any, what: str) -> None:
    """The call that closes is the last one, even if more publishes had already been fetched for the next
    calls.
    """
    subscription, other = link.subscribe([1], divisor=10), link.subscribe([2], divisor=10)
    got: list[int] = []
    others: list[int] = []
    closed, called, go_on = threading.Event(), threading.Event(), threading.Event()

    def callback(time_s: float, words: tuple[int, ...]) -> None:
        got.append(words[0])
        if len(got) == 1:
            called.set()
            assert go_on.wait(20)  # wait until more publishes have come, which are then fetched together
        if len(got) == 5:
            {"itself": subscription, "another": other, "link": link}[what].close()
            closed.set()

    subscription.on_publish(callback)
    other.on_publish(lambda time_s, words: others.append(words[0]))
    numbered(device, subscription, range(1))
    assert called.wait(20)
    numbered(device, subscription, range(1, 20))
    numbered(device, other, range(3))
    while subscription.available < 19 or other.available < 3:
        assert subscription.wait(20)
    go_on.set()
    assert closed.wait(20)
    subscription.close()
    link.close()
    rest = subscription.drain()[1][:, 0].tolist()
    assert got + rest == list(range(20))
    assert len(got) == (20 if what == "another" else 5)
    assert others + other.drain()[1][:, 0].tolist() == list(range(3))


def test_callbacks_that_close_each_other_do_not_wait_for_each_other() -> None:
    """Each callback closes the other's subscription, while both are in their first call."""
    with (
        Board() as one,
        Board() as two,
        Link(f"{one.url}?timeout={HOURS_S}") as first,
        Link(f"{two.url}?timeout={HOURS_S}") as second,
    ):
        both = threading.Barrier(2)
        subscriptions = [first.subscribe([1], divisor=1), second.subscribe([1], divisor=1)]
        done: queue.SimpleQueue[object] = queue.SimpleQueue()

        def closer(other: int) -> Any:
            calls: list[float] = []

            def callback(time_s: float, words: tuple[int, ...]) -> None:
                calls.append(time_s)
                if len(calls) > 1:  # the other callback has not closed this subscription yet
                    return
                both.wait()
                try:
                    subscriptions[other].close()
                    done.put(other)
                except BaseException as error:  # it waited for the other one until a timeout
                    done.put(error)
                    raise

            return callback

        for number, subscription in enumerate(subscriptions):
            subscription.on_publish(closer(1 - number))
        assert {done.get(), done.get()} == {0, 1}
        assert done.empty()


def test_close_waits_for_a_running_call(link: Link, device: Any) -> None:
    subscription = link.subscribe([1], divisor=10)
    under_way, go_on = threading.Event(), threading.Event()
    order: list[str] = []

    def callback(time_s: float, words: tuple[int, ...]) -> None:
        under_way.set()
        assert go_on.wait(20)
        subscription.close()  # although another thread is closing it, and waits
        order.append("called")

    def close() -> None:
        subscription.close()
        order.append("closed")

    subscription.on_publish(callback)
    numbered(device, subscription, range(3))
    assert under_way.wait(20)
    closing = threading.Thread(target=close)
    closing.start()
    while link._native.subscribed(subscription._identity):
        assert not order
    go_on.set()
    closing.join(20)
    assert order == ["called", "closed"]
    assert subscription.drain()[1].tolist() == [[1], [2]]


def test_who_waits_and_who_iterates_gets_the_rest(link: Link, device: Any) -> None:
    subscription = link.subscribe([1], divisor=10)
    got: list[int] = []

    def read() -> None:
        with pytest.raises(LinkClosed, match="the subscription is closed"):
            while subscription.wait(20):
                got.extend(subscription.drain()[1][:, 0].tolist())

    reading = threading.Thread(target=read)
    reading.start()
    numbered(device, subscription, range(300))
    subscription.close()
    reading.join(20)
    assert got == list(range(300))

    async def iterate() -> list[int]:
        again = link.subscribe([1], divisor=10)
        listening = asyncio.ensure_future(listen(again))
        await asyncio.sleep(0)
        numbered(device, again, range(300))
        again.close()
        return await asyncio.wait_for(listening, 20)

    async def listen(publishes: Any) -> list[int]:
        return [words[0] async for _, words in publishes]

    assert asyncio.run(iterate()) == list(range(300))


@pytest.mark.parametrize("what", ["subscription", "link"])
def test_publishes_from_before_the_loss_of_the_port_reach_the_callback(
    link: Link, device: Any, what: str
) -> None:
    subscription = link.subscribe([1], divisor=10)
    got: list[int] = []
    go_on = threading.Event()

    def callback(time_s: float, words: tuple[int, ...]) -> None:
        go_on.wait(20)
        got.append(words[0])

    subscription.on_publish(callback)
    numbered(device, subscription, range(50))
    device.unplug()
    while not link.closed:
        assert not got
    go_on.set()
    (subscription if what == "subscription" else link).close()
    assert got == list(range(50))


@pytest.mark.parametrize("what", ["link", "subscription", "event"])
def test_closing_does_not_wait_for_a_callback_that_does_not_return(
    link: Link, device: Any, what: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("unitylink.layer2_message.callbacks.STUCK_S", 0.1)
    subscription = link.subscribe([1], divisor=10)
    within, go_on = threading.Event(), threading.Event()
    calls: list[object] = []

    def stuck(*publish: object) -> None:
        calls.append(publish)
        within.set()
        go_on.wait()

    if what == "event":
        link.on_event(lambda _: None)
    subscription.on_publish(stuck)
    numbered(device, subscription, range(3))
    assert within.wait(10)
    try:
        with pytest.warns(RuntimeWarning, match="<Subscription of 1 words.*> has not returned for 0.1 s"):
            (subscription if what == "subscription" else link).close()
        threads = [thread for thread in threading.enumerate() if thread.name == "unitylink callbacks"]
    finally:
        go_on.set()
    for thread in threads:
        thread.join(10)
        assert what == "subscription" or not thread.is_alive()
    assert len(calls) == 1, "it is not called again"


def test_closing_waits_for_slow_callbacks_that_return(
    link: Link, device: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("unitylink.layer2_message.callbacks.STUCK_S", 0.2)
    subscription = link.subscribe([1], divisor=10)
    calls: list[int] = []

    def slow(_: float, words: tuple[int, ...]) -> None:
        threading.Event().wait(0.05)
        calls.append(words[0])

    subscription.on_publish(slow)
    numbered(device, subscription, range(12))
    while not calls:
        threading.Event().wait(0.001)
    link.close()
    assert calls == list(range(len(calls)))
    assert not len(subscription.drain()[1]), "all that had come was called back for"
