# SPDX-License-Identifier: BSD-3-Clause
"""Which group carries which value, and which callbacks are called."""

from __future__ import annotations

import logging
import threading
from types import ModuleType
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from unitylink import connect
from unitylink.errors import DeviceMismatch, LinkClosed, LinkTimeout, ValueRangeError
from unitylink.layer3_hardware import MemoryProxy
from unitylink.layer4_data import Publisher, ReadValue, Recording, ValueGroup
from unitylink.layer4_data.publishing import plan
from unitylink.simulate import Board
from unitylink.spec.model import Publish


def values(
    hardware: Any, publisher: Publisher, publishes: list[tuple[int, int] | None], first: int = 0
) -> list[ReadValue]:
    return [
        ReadValue(f"v{first + n}", hardware, first + n, signed=True, publish=publish, publisher=publisher)
        for n, publish in enumerate(publishes)
    ]


@given(publishes=st.lists(st.tuples(st.sampled_from([1, 2]), st.integers(1, 4)), max_size=40))
def test_plan_keeps_what_belongs_together(fake: ModuleType, publishes: list[tuple[int, int]]) -> None:
    link = fake.FakeLink(configuration=fake.Configuration(groups=200, group_size=9))
    items = values(MemoryProxy(link), Publisher(), list(publishes))
    plans = plan((value, Publish(*publish)) for value, publish in zip(items, publishes, strict=True))
    seen = [value for item in plans for value in item.values]
    assert sorted(seen, key=lambda value: value.address) == items, "each value exactly once"
    for item in plans:
        assert all(value.publish == Publish(item.mode, item.divisor) for value in item.values)
        assert item.mode == 2 or len(item.values) <= 8
    for mode, divisor in set(publishes):
        count = publishes.count((mode, divisor))
        groups = sum((item.mode, item.divisor) == (mode, divisor) for item in plans)
        assert groups == (1 if mode == 2 else -(-count // 8)), "split only when a group is full"


def test_too_many_groups_is_said_with_counts(fake: ModuleType) -> None:
    link = fake.FakeLink(configuration=fake.Configuration(groups=2, group_size=3))
    publisher = Publisher()
    items = values(MemoryProxy(link), publisher, [(1, 10)] * 5)
    with pytest.raises(
        DeviceMismatch, match=r"has 2 publish groups of 2 values, 3 are needed \(5 values at 100"
    ):
        publisher.start()
    assert not publisher.active and not link.subscriptions
    publisher.start(fallback=True)
    assert [(r.hardware, len(r.paths)) for r in publisher.reports()] == [(True, 2), (True, 2), (False, 1)]
    publisher.stop()
    assert not link.subscriptions and items


def test_gateware_without_publishing(fake: ModuleType) -> None:
    link = fake.FakeLink(configuration=fake.Configuration(publish_mode=0, base_hz=0, groups=0))
    publisher = Publisher()
    (value,) = values(MemoryProxy(link), publisher, [(1, 1)])
    with pytest.raises(DeviceMismatch, match="has 0 publish groups"):
        publisher.start()
    got = threading.Event()
    link.bus.words = {0: 5}
    publisher.start(fallback=True)
    value.on_publish(lambda time_s, number: got.set() if number == 5 else None)
    assert got.wait(10)
    publisher.stop()


def test_one_publish_is_one_consistent_snapshot(fake: ModuleType) -> None:
    link = fake.FakeLink()
    publisher = Publisher()
    a, b = values(MemoryProxy(link), publisher, [(1, 10), (1, 10)])
    group = ValueGroup([a, b])
    seen: list[Any] = []
    a.on_change(lambda number: seen.append(("a", number, b.latest)))
    group.on_publish(lambda time_s, snapshot: seen.append((time_s, dict(snapshot))))
    group.on_change(lambda snapshot: seen.append(dict(snapshot)))
    assert publisher.active, "a callback starts the publishing"
    link.bus.words = {0: 1, 1: 0xFFFFFFFF}
    link.publish(2.5)
    link.publish(3.5)
    assert seen == [
        ("a", 1, -1),  # b is already up to date when a's callback runs
        (2.5, {"v0": 1, "v1": -1}),
        {"v0": 1, "v1": -1},
        (3.5, {"v0": 1, "v1": -1}),
    ]
    publisher.stop()


def test_a_group_over_two_links_is_called_once_for_each_set(fake: ModuleType) -> None:
    left, right = fake.FakeLink(url="left:"), fake.FakeLink(url="right:")
    (a,) = values(MemoryProxy(left), Publisher(), [(1, 10)])
    (b,) = values(MemoryProxy(right), Publisher(), [(1, 10)], first=1)
    seen: list[Any] = []
    ValueGroup([a, b]).on_publish(lambda time_s, snapshot: seen.append((dict(snapshot), snapshot.times_s)))
    left.publish(1.0)
    left.publish(2.0)
    assert not seen
    right.publish(3.0)
    assert seen == [({"v0": 0, "v1": 0}, {"left:": 2.0, "right:": 3.0})]


def test_callbacks_that_raise_are_reported(fake: ModuleType, caplog: pytest.LogCaptureFixture) -> None:
    link = fake.FakeLink()
    (value,) = values(MemoryProxy(link), Publisher(), [(1, 10)])
    seen: list[int] = []

    def bad(time_s: float, number: int) -> None:
        raise KeyError("mine")

    value.on_publish(bad)
    take_back = value.on_publish(lambda time_s, number: seen.append(number))
    with caplog.at_level(logging.ERROR, "unitylink.publishing"):
        link.publish()
        link.publish()
    assert seen == [0, 0]
    assert caplog.text.count("v0: the callback") == 2 and "mine" in caplog.text
    take_back()
    link.publish()
    assert seen == [0, 0]


def test_a_link_that_its_program_closes_under_a_callback_is_no_news(
    fake: ModuleType, caplog: pytest.LogCaptureFixture
) -> None:
    """A program ends while a callback writes. That of a line that is lost is news."""
    with Board() as board:
        real = connect(board.url)
        real.close()
        with pytest.raises(LinkClosed) as ours:
            real.write(0, 1)
    link = fake.FakeLink()
    (value,) = values(MemoryProxy(link), Publisher(), [(1, 10)])
    raised: list[LinkClosed] = [ours.value.with_item("motor.duty")]

    def write(*_: object) -> None:
        raise raised[0]

    value.on_publish(write)
    value.on_change(write)
    link.publish()
    assert caplog.text == ""
    raised[0] = LinkClosed("the other side closed the connection")
    link.publish()
    assert caplog.text.count("v0: the callback") == 1


def test_values_without_publish_need_a_rate(fake: ModuleType) -> None:
    link = fake.FakeLink()
    publisher = Publisher()
    (value, other) = values(MemoryProxy(link), publisher, [None, (1, 10)])
    with pytest.raises(ValueRangeError, match="v0 has no PUBLISH in the spec"):
        value.on_change(print)
    with pytest.raises(ValueRangeError, match="rate_hz 0 is not above 0"):
        value.on_change(print, rate_hz=0)
    with pytest.raises(ValueRangeError, match="the spec gives its rate"):
        other.on_change(print, rate_hz=5)
    with pytest.raises(ValueRangeError, match="no READ to be published"):
        ValueGroup([]).on_publish(print)
    got = threading.Event()
    value.on_publish(lambda time_s, number: got.set(), rate_hz=1000)
    assert got.wait(10)
    assert [(r.hardware, r.rate_hz) for r in publisher.reports()] == [(True, 100.0), (False, 1000.0)]
    publisher.stop()


def test_polling_survives_timeouts_and_ends_with_the_link(
    fake: ModuleType, caplog: pytest.LogCaptureFixture
) -> None:
    link = fake.FakeLink()
    publisher = Publisher()
    (value,) = values(MemoryProxy(link), publisher, [(2, 1)])
    link.fail = {0: LinkTimeout("unanswered")}
    got = threading.Event()
    value.on_publish(lambda time_s, number: got.set())
    while publisher.reports()[0].lost < 5:
        pass
    assert not got.is_set()
    link.fail = {}
    assert got.wait(10)
    assert caplog.text.count("unanswered") == 1 and caplog.text.count("polled again") == 1
    link.fail = {0: LinkClosed("unplugged")}
    poller = publisher._running[0].source
    poller._thread.join(10)  # type: ignore[union-attr]
    assert not poller._thread.is_alive()  # type: ignore[union-attr]
    assert "polling ends: unplugged" in caplog.text
    publisher.stop()


def test_a_callback_may_stop_the_polling(fake: ModuleType) -> None:
    publisher = Publisher()
    (value,) = values(MemoryProxy(fake.FakeLink()), publisher, [(2, 1)])
    done = threading.Event()

    def stop(time_s: float, number: int) -> None:
        publisher.stop()
        done.set()

    value.on_publish(stop)
    assert done.wait(10) and not publisher.active


def test_recording(fake: ModuleType) -> None:
    link = fake.FakeLink()
    publisher = Publisher()
    values(MemoryProxy(link), publisher, [(1, 10), (1, 20)])
    with publisher.running(), Recording(publisher) as recording:
        for number in range(3):
            link.bus.words = {0: number, 1: 100 + number}
            link.publish(float(number))
    link.publish(9.0)
    times_s, numbers = recording.series("v1")
    assert times_s.tolist() == [0, 1, 2] and numbers.tolist() == [100, 101, 102]
    with pytest.raises(KeyError, match="nothing was published"):
        recording.series("v7")


def test_publishes_come_as_arrays_where_nobody_wants_each(fake: ModuleType) -> None:
    link = fake.FakeLink()
    publisher = Publisher()
    first, second = values(MemoryProxy(link), publisher, [(1, 10), (1, 10)])
    times = np.array([1.0, 2.0])
    words = np.array([[3, 4], [5, 0xFFFF_FFFF]], np.uint32)
    with publisher.running(), Recording(publisher) as recording:
        (subscription,) = link.subscriptions
        assert subscription.arrays(times, words)
        assert (first.latest, second.latest) == (5, second.codec.decode(0xFFFF_FFFF))
        subscription.callback(3.0, (7, 8))
        told: list[int] = []
        remove = first.on_publish(lambda _, number: told.append(number))
        assert not subscription.arrays(times, words) and told == []
        remove()
        publisher.take_with(lambda *_: None)
        assert not subscription.arrays(times, words)
        assert publisher.reports()[0].received == 3
    times_s, numbers = recording.series("v0")
    assert times_s.tolist() == [1, 2, 3] and numbers.tolist() == [3, 5, 7]


def test_a_rate_too_slow_for_the_gateware_is_named_or_polled(fake: ModuleType) -> None:
    link = fake.FakeLink(configuration=fake.Configuration(rate_bytes=1))
    (value,) = values(MemoryProxy(link), Publisher(), [(1, 256)])
    with pytest.raises(DeviceMismatch, match=r"v0: .* base rate / 256; its rates have 1 byte"):
        plan([(value, Publish(1, 256))])
    assert [item.mode for item in plan([(value, Publish(1, 256))], fallback=True)] == [2]
    assert [item.mode for item in plan([(value, Publish(1, 255))])] == [1]
