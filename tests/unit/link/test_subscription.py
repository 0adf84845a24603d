# SPDX-License-Identifier: BSD-3-Clause
"""Subscriptions after and beside each other, what callbacks may do, and how all of them learn of the end."""

from __future__ import annotations

import asyncio
import os
import queue
import threading
import time
from pathlib import Path
from typing import Any, cast

import pytest

from unitylink import Link, LinkBusy, LinkClosed
from unitylink._native import NativeLink
from unitylink.layer2_message.callbacks import CallbackThread
from unitylink.simulate import Board, BoardConfiguration


def publish(device: Any, subscription: Any, count: int) -> None:
    for _ in range(count):
        device.publish(subscription.group)
    while subscription.available < count:
        assert subscription.wait(10)


def test_a_closed_subscription_gets_nothing_from_the_next_one_in_its_group(link: Link, device: Any) -> None:
    first = link.subscribe([1, 2, 3], divisor=10)
    publish(device, first, 2)
    first.close()
    assert first.drain()[1].shape == (2, 3)  # these came before it was closed
    second = link.subscribe([4], divisor=10)
    assert second.group == first.group
    publish(device, second, 3)
    assert first.available == first.lost == 0
    assert first.drain()[1].shape == (0, 3)
    with pytest.raises(LinkClosed, match="the subscription is closed"):
        first.wait(3600)
    with pytest.raises(LinkClosed, match="the subscription is closed"):
        first.on_publish(lambda time_s, words: None)
    first.close()
    assert second.drain()[1].tolist() == [[device.memory[4]]] * 3
    assert device.rates[second.group] == 10


def test_a_callback_may_read_write_and_subscribe(link: Link, device: Any) -> None:
    done = threading.Event()
    got: list[object] = []

    def callback(time_s: float, words: tuple[int, ...]) -> None:
        link.write(5, 77)
        got.append(link.read(5))
        with link.subscribe([9], divisor=3) as other:
            got.append(other.group)
        done.set()

    subscription = link.subscribe([1], divisor=10)
    subscription.on_publish(callback)
    device.publish(subscription.group)
    assert done.wait(10)
    assert got == [77, 1]


def test_the_callback_thread_rests_while_all_may_wait(
    link: Link, device: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    rests: queue.SimpleQueue[float] = queue.SimpleQueue()
    monkeypatch.setattr(link._callbacks, "_rest", rests.put)
    called: queue.SimpleQueue[tuple[int, ...]] = queue.SimpleQueue()

    def callback(time_s: float, words: tuple[int, ...]) -> None:
        called.put(words)

    patient, urgent = (link.subscribe([address], divisor=10) for address in (1, 2))
    patient.on_publish(callback, gather_s=0.02)
    while rests.empty():  # publishes that come rarely are not waited for
        device.publish(patient.group)
        called.get(timeout=10)
    assert rests.get() == 0.02
    urgent.on_publish(callback)
    device.publish(urgent.group)  # after its delivery there are no pauses
    called.get(timeout=10)
    while not rests.empty():
        rests.get()
    for subscription in (patient, urgent):
        device.publish(subscription.group)
        called.get(timeout=10)
    assert rests.empty()


def test_several_publishes_are_first_offered_as_arrays(link: Link, device: Any) -> None:
    got: queue.SimpleQueue[object] = queue.SimpleQueue()
    go_on = threading.Event()
    taken = [False, True]

    def each(time_s: float, words: tuple[int, ...]) -> None:
        got.put(words)
        go_on.wait(10)

    def arrays(times: Any, words: Any) -> bool:
        got.put(words.tolist())
        return taken.pop()

    subscription = link.subscribe([1, 2], divisor=10)
    subscription.on_publish(each, arrays=arrays)
    row = (device.memory[1], device.memory[2])
    # the arrays are taken, then refused; in the third round the callback raises, which stops nothing
    for after in ([], [row, row], []):
        go_on.clear()
        device.publish(subscription.group)
        assert got.get(timeout=10) == row  # a single publish is not offered as an array
        publish(device, subscription, 2)
        go_on.set()
        assert got.get(timeout=10) == [list(row), list(row)]
        assert [got.get(timeout=10) for _ in after] == after
    subscription.on_publish(lambda time_s, words: got.put(words))
    device.publish(subscription.group)
    assert got.get(timeout=10) == row


def test_a_program_may_drain_by_itself_in_the_thread_of_the_callbacks(
    link: Link, device: Any, caplog: pytest.LogCaptureFixture
) -> None:
    """It gets all, even after an error of its own, can be replaced, and is not called after the end."""
    got: queue.SimpleQueue[object] = queue.SimpleQueue()
    broken = [True]

    def take(native: Any, identity: int) -> None:
        if native.available(identity) and broken and broken.pop():
            raise RuntimeError("not this time")
        for row in native.drain(identity, 2)[1].tolist():
            got.put(row)

    subscription = link.subscribe([1, 2], divisor=10)
    subscription.hand_over(take)
    row = [device.memory[1], device.memory[2]]
    for _ in range(4):
        device.publish(subscription.group)
    assert [got.get(timeout=10) for _ in range(4)] == [row] * 4
    assert "not this time" in caplog.text
    replaced = threading.Event()
    subscription.on_publish(lambda time_s, words: replaced.set())
    while not replaced.wait(0.01):  # what is under way may still be taken by the one before
        device.publish(subscription.group)
    while not got.empty():
        got.get()
    subscription.hand_over(take)
    while got.empty():
        device.publish(subscription.group)
        time.sleep(0.01)
    while not got.empty():
        got.get()
    for _ in range(2):
        device.publish(subscription.group)
    link.read(1)  # they came before its answer
    subscription.close()
    taken = [got.get(timeout=10) for _ in range(2)]
    while not got.empty():  # one more that came before these two
        taken.append(got.get())
    assert taken == [row] * len(taken)
    with pytest.raises(LinkClosed):
        subscription.hand_over(take)


def test_a_program_that_drains_and_closes_is_not_called_again(link: Link, device: Any) -> None:
    found: list[int] = []
    closed = threading.Event()
    subscription = link.subscribe([1], divisor=10)

    def take(native: Any, identity: int) -> None:
        found.append(native.available(identity))
        if found[-1]:
            subscription.close()
            closed.set()

    subscription.hand_over(take)
    device.publish(subscription.group)
    assert closed.wait(10)
    link.close()
    assert found.pop() and not any(found)  # the last call is the one that closed
    assert len(subscription.drain()[0])  # and nothing is lost


@pytest.mark.parametrize("what", ["subscription", "link"])
def test_a_callback_that_closes_is_not_called_again(link: Link, device: Any, what: str) -> None:
    got: list[tuple[int, ...]] = []
    closed = threading.Event()
    subscription = link.subscribe([1], divisor=10)
    publish(device, subscription, 20)

    def callback(time_s: float, words: tuple[int, ...]) -> None:
        got.append(words)
        subscription.close()
        if what == "link":
            link.close()
        closed.set()

    subscription.on_publish(callback)
    assert closed.wait(10)
    link.close()
    assert len(got) == 1


def test_sys_exit_in_a_callback_silences_nobody(
    link: Link, device: Any, caplog: pytest.LogCaptureFixture
) -> None:
    got: list[int] = []
    enough = threading.Event()

    def callback(time_s: float, words: tuple[int, ...]) -> None:
        got.append(len(got))
        if len(got) == 3:
            enough.set()
        raise SystemExit(1)

    subscription = link.subscribe([1], divisor=10)
    subscription.on_publish(callback)
    for _ in range(3):
        device.publish(subscription.group)
    assert enough.wait(10)
    link.close()
    assert "failed; the publishes go on" in caplog.text


def test_subscribing_and_closing_again_and_again(link: Link, device: Any) -> None:
    kept = link.subscribe([7], divisor=10)
    for round_ in range(300):
        with link.subscribe([round_ % 256], divisor=10) as subscription:
            assert subscription.group == 1
            publish(device, subscription, 1)
            assert subscription.drain()[1].tolist() == [[device.memory[round_ % 256]]]
    publish(device, kept, 1)
    assert kept.drain()[1].tolist() == [[device.memory[7]]]


def test_all_waiting_callers_learn_that_the_port_is_gone(
    link: Link, device: Any, caplog: pytest.LogCaptureFixture
) -> None:
    subscription = link.subscribe([1], divisor=10)
    subscription.on_publish(lambda time_s, words: None)
    thread = link._callbacks._thread
    device.unplug()
    with pytest.raises(LinkClosed, match="the other side closed the connection"):
        while True:
            subscription.wait(3600)

    async def listen() -> None:
        async for _ in subscription:
            pass

    with pytest.raises(LinkClosed, match="the other side closed the connection"):
        asyncio.run(listen())
    assert thread is not None
    thread.join(10)
    assert "no more callbacks: the link is closed (the other side closed the connection)" in caplog.text


def test_all_waiting_callers_learn_that_another_program_has_the_board(link: Link, device: Any) -> None:
    subscription = link.subscribe([1], divisor=10)
    device.send(b"?busy\n")
    with pytest.raises(LinkBusy):
        while True:
            subscription.wait(3600)


def test_closing_is_not_an_error_to_who_iterates(link: Link, device: Any) -> None:
    async def main() -> None:
        subscription = link.subscribe([1], divisor=10)

        async def listen() -> None:
            async for _ in subscription:
                raise AssertionError("nothing was published")

        listener = asyncio.ensure_future(listen())
        await asyncio.sleep(0)
        link.close()
        await asyncio.wait_for(listener, 10)
        with pytest.raises(LinkClosed, match="closed by this program"):
            subscription.wait(3600)

    asyncio.run(main())


@pytest.mark.parametrize("data_bits", [8, 32])
def test_events(data_bits: int) -> None:
    from unitylink import connect

    edges = BoardConfiguration(data_bits=data_bits, edge_events=(0, 1))
    with Board(configuration=edges) as board, connect(board.url) as link:
        timed = link.subscribe([1], divisor=65535)
        subscription = link.subscribe([2], on_event=True)
        board.registers[2] = 9
        board.event(subscription.group)
        assert subscription.wait(10)
        assert subscription.drain()[1].tolist() == [[9]]
        timed.close()
        board.event(subscription.group)  # the end of the other subscription left this event alone
        assert subscription.wait(10)
        subscription.close()
        again = link.subscribe([2], divisor=65535)
        again.drain()
        board.event(again.group)  # no subscription uses this event any more
        assert link.read(2) == 9
        assert again.available == 0


@pytest.mark.parametrize(("period_s", "rests"), [(0.03, False), (0.0005, True)])
def test_the_callback_thread_rests_only_if_that_gathers_publishes(
    period_s: float, rests: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With rare publishes, a rest would only wake the thread once more for each."""

    class Native:
        in_steps = False
        closed = False
        seen = 0

        def wait_publishes(self, seen: int, timeout_ns: int) -> int:
            time.sleep(period_s)
            self.seen += 1
            self.closed = self.seen > 5
            return seen if self.closed else self.seen

        def check_alive(self) -> None:
            pass

    class Stream:
        gather_s = 0.01
        told = 0
        ended = False

        def deliver(self) -> None:
            self.told += 1

        def hush(self) -> None:
            pass

    thread, rested = CallbackThread(cast(NativeLink, Native())), list[float]()
    monkeypatch.setattr(thread, "_rest", rested.append)
    stream = Stream()
    thread.add(stream)
    thread.stop()
    assert stream.told > 5
    assert len(rested) >= 3 if rests else not rested


def test_a_thread_that_reads_all_publishes_does_not_wake_the_reader_for_each() -> None:
    """At 100 Hz the reader looked 250 times a second whether it was needed."""

    def switches(thread: str) -> int:
        state = Path(f"/proc/self/task/{thread}/status").read_text()
        return int(state.partition("\nvoluntary_ctxt_switches:")[2].split()[0])

    came = threading.Semaphore(0)
    with Board(configuration=BoardConfiguration(), endpoint="tcp") as board:
        others = set(os.listdir("/proc/self/task"))
        with Link(board.url) as link:
            subscription = link.subscribe([1], divisor=10)  # of 1 kHz
            subscription.on_publish(lambda time_s, words: came.release())
            for _ in range(20):
                assert came.acquire(timeout=10)
            callbacks = {str(one.native_id) for one in threading.enumerate()}
            (reader,) = set(os.listdir("/proc/self/task")) - others - callbacks
            before = switches(reader)
            for _ in range(100):
                assert came.acquire(timeout=10)
            assert switches(reader) - before < 100
