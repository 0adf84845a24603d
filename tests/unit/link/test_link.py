# SPDX-License-Identifier: BSD-3-Clause
"""Link from Python with the fake device: values, errors as exceptions, publishes, threads."""

from __future__ import annotations

import gc
import os
import threading
import time
from types import ModuleType
from typing import Any

import numpy as np
import pytest

from unitylink import (
    BusError,
    DeviceMismatch,
    Link,
    LinkBusy,
    LinkClosed,
    LinkError,
    LinkNotFound,
    LinkTimeout,
    OutcomeUnknown,
    ProtocolError,
    UrlError,
    ValueRangeError,
    connect,
)


def test_configuration(link: Link) -> None:
    told = link.configuration
    assert (told.address_bytes, told.data_bytes, told.read_many, told.base_hz) == (1, 4, 32, 1000)
    assert (told.groups, told.group_size, told.usable_group_size, told.rate_bytes) == (2, 16, 15, 2)
    assert told.discovered
    assert (told.data_bits, told.address_bits) == (32, 8)


def test_words(link: Link, device: Any) -> None:
    assert link.read(0x12) == 0x40DE1212
    link.write(0x20, 0xDEADBEEF)
    assert device.memory[0x20] == 0xDEADBEEF
    assert link.read(np.uint16(0x20), checked=True) == 0xDEADBEEF
    link.write_many([1, 2], np.array([3, 4], dtype=np.uint8), checked=True)
    for values in (
        link.read_many([1, 2]),
        link.read_each([1, 2]),
        link.read_many(np.array([1, 2]), atomic=True),
    ):
        assert values.dtype == np.uint32
        assert values.tolist() == [3, 4]
    assert link.read_many(range(100)).tolist() == [device.memory[address] for address in range(100)]
    assert link.read_many([]).shape == (0,)


def test_many_words_are_few_messages(link: Link, device: Any) -> None:
    device.log.clear()
    link.read_many(range(64))
    assert device.log == ["RM", "RM"]
    with pytest.raises(DeviceMismatch, match="at most 32 words at once, not 64"):
        link.read_many(range(64), atomic=True)


@pytest.mark.parametrize(
    ("call", "text"),
    [
        (lambda link: link.read(256), "address 0x100 does not fit the device's 8-bit addresses"),
        (lambda link: link.read(-1), "address -1 is not in"),
        (lambda link: link.read(1 << 70), "is not in 0..0xffffffff"),
        (lambda link: link.read("x"), "must be a whole number, not 'x'"),
        (lambda link: link.read(1.5), "must be a whole number"),
        (lambda link: link.write(0, 1 << 32), "value 4294967296 is not in"),
        (lambda link: link.write(0, -1), "value -1"),
        (lambda link: link.write_many([1, 2], [3]), "2 addresses but 1 values"),
        (lambda link: link.read_many(7), "must be a sequence"),
        (lambda link: link.exchange([1], 7), "writes must be a sequence of pairs"),
        (lambda link: link.exchange([1], [(2, 3), 7]), r"a write must be a pair \(address, value\), not 7"),
        (lambda link: link.exchange([1], [(2, 3, 4)]), r"must be a pair .* not \(2, 3, 4\)"),
        (lambda link: link.exchange([1], [("x", 3)]), "address must be a whole number, not 'x'"),
        (lambda link: link.exchange([1], [(2, 1 << 32)]), "value 4294967296 is not in"),
        (lambda link: link.exchange([1], [(2, 3), (300, 4)]), "0x12c does not fit"),
        (lambda link: link.read_many([1, 300]), "0x12c does not fit"),
        (lambda link: link.read(1, timeout_s=0), "timeout_s must be above 0"),
        (lambda link: link.subscribe([1], divisor=65536), "divisor 65536 is above 65535"),
        (lambda link: link.subscribe([1]), "nothing would ever be published"),
        (lambda link: link.subscribe([], divisor=1), "no addresses"),
    ],
)
def test_wrong_values_are_refused_before_anything_is_sent(
    link: Link, device: Any, call: Any, text: str
) -> None:
    device.log.clear()
    with pytest.raises(ValueRangeError, match=text):
        call(link)
    assert device.log == []


def test_bus_error_names_the_address(link: Link, device: Any) -> None:
    device.silent = {9}
    with pytest.raises(BusError, match=r"read of 0x09: .*E_BAT.*nothing on its bus answered") as caught:
        link.read(9)
    assert caught.value.address == 9
    assert caught.value.attempts == 1


def test_timeout_says_what_how_often_and_how_long(link: Link, device: Any) -> None:
    device.intercept = lambda command, data: b""
    with pytest.raises(
        LinkTimeout, match=r"read of 0x88 unanswered after 3 attempts in .* ms; the device last"
    ) as caught:
        # timeout of each attempt, so long that even a busy machine sends all three
        link.read(0x88, timeout_s=0.05)
    error = caught.value
    assert (error.address, error.attempts) == (0x88, 3)
    assert error.elapsed_s >= 0.15
    assert str(error.with_item("j1.cpos")).startswith("j1.cpos: read of 0x88")
    device.intercept = lambda command, data: None
    assert link.read(0x88) == device.memory[0x88]


def test_a_lost_answer_to_a_write_is_unknown_unless_it_may_be_repeated(link: Link, device: Any) -> None:
    lost: list[bytes] = []

    def lose_one(command: str, data: bytes) -> bytes | None:
        if command == "W" and not lost:
            lost.append(data)
            return b""
        return None

    device.intercept = lose_one
    device.log.clear()
    with pytest.raises(OutcomeUnknown, match=r"write of 0x05 .*may or may not have been executed"):
        link.write(5, 6)
    assert device.log == ["W"]
    lost.clear()
    link.write(5, 6, repeat=True)
    assert device.memory[5] == 6
    assert device.log == ["W", "RLC", "W", "RLC", "W"]


@pytest.mark.parametrize(
    "bad",
    [b"#S_R:4\n", b"#S_R:40de1212*2d\n", b"?f4\n", b"$S_R:40de1212*00\n", b"#S_W\n", b"\xff#S_R:40de12\n"],
)
def test_a_bad_reply_is_never_a_value(link: Link, device: Any, bad: bytes) -> None:
    answers = [bad]
    device.intercept = lambda command, data: answers.pop() if command == "R" and answers else None
    assert link.read(0x12) == 0x40DE1212
    assert link.statistics().fences >= 2


def test_replies_that_stay_wrong_end_in_an_error(link: Link, device: Any) -> None:
    device.intercept = lambda command, data: b"#S_R:zz\n" if command == "R" else None
    with pytest.raises(ProtocolError, match="not answered correctly after 3 attempts"):
        link.read(1)
    device.intercept = lambda command, data: b"#?E_ICC\n" if command == "RM" else None
    with pytest.raises(ProtocolError, match="E_ICC: this gateware has no such command"):
        link.read_many([1, 2])


def test_after_a_failed_write_the_rest_is_not_sent(link: Link, device: Any) -> None:
    device.intercept = lambda command, data: b"#?E_FBW\n" if command == "W" and data[0] == 2 else None
    with pytest.raises(
        BusError, match=r"write 2 of 4: write of 0x02: .*E_FBW.*; 2 later ones were not sent"
    ) as caught:
        link.write_many([1, 2, 3, 4], [5, 6, 7, 8])
    assert caught.value.address == 2
    assert device.memory[1] == 5
    assert device.memory[3] != 7


def test_connecting_to_a_device_in_mid_message_that_publishes(fake: ModuleType) -> None:
    device = fake.FakeDevice(banner=b"12*ba\n&PUB:000240de101040de1111*ba\n#S_R:00000001\n")
    with connect(device.url()) as link:
        assert link.read(0x12) == 0x40DE1212
        assert link.statistics().unclaimed_publishes == 1
    device.close()


def test_without_rlc_the_widths_come_from_the_url(fake: ModuleType) -> None:
    device = fake.FakeDevice(configuration=None)
    with pytest.raises(DeviceMismatch, match=r"no RLC command.*address_bytes=…&data_bytes=…"):
        connect(device.url())
    device.close()
    device = fake.FakeDevice(configuration=None)
    with connect(device.url("address_bytes=1&data_bytes=4&timeout=0.1")) as link:
        assert not link.configuration.discovered
        assert link.read(0x12) == 0x40DE1212
    device.close()
    device = fake.FakeDevice()
    with pytest.raises(DeviceMismatch, match="the URL says data_bytes=2, the device reports 4"):
        connect(device.url("data_bytes=2"))
    device.close()


def test_publishes_as_arrays(link: Link, device: Any) -> None:
    with link.subscribe([1, 2, 3], divisor=10, ring=4) as subscription:
        assert device.groups[subscription.group] == [1, 2, 3]
        assert device.rates[subscription.group] == 10
        assert subscription.drain()[1].shape == (0, 3)
        for value in range(6):
            device.memory[2] = value
            device.publish(subscription.group)
        while subscription.available + subscription.lost < 6:
            assert subscription.wait(5)
        times, values = subscription.drain()
        assert values.dtype == np.uint32
        assert values[:, 1].tolist() == [2, 3, 4, 5]
        assert subscription.lost == 2
        assert (np.diff(times) >= 0).all()
        assert not subscription.wait(0)
    assert device.rates[subscription.group] == 0
    assert device.log[-2:] == ["DPS", "WSR"]


def test_subscribing_never_does_what_2012_gateware_cannot_bear(link: Link, device: Any) -> None:
    device.silent = {9}
    with pytest.raises(BusError, match="every address is read once before it is published"):
        link.subscribe([1, 9], divisor=1)
    assert "WSA" not in device.log
    with pytest.raises(DeviceMismatch, match=r"can hold 15 .one less than it reports"):
        link.subscribe(range(16), divisor=1)
    device.log.clear()
    subscription = link.subscribe([1], divisor=1)
    assert device.log == ["R", "DPS", "WSR", "WSR", "WIC", "WSR", "WSA", "WSR", "EPC"]
    assert subscription.group == 0
    link.subscribe([2], on_event=True, verify=False)
    with pytest.raises(DeviceMismatch, match="all 2 groups of this gateware are in use"):
        link.subscribe([3], divisor=1)


def test_callbacks_in_their_own_thread_and_errors_that_do_not_stop_them(
    link: Link, device: Any, caplog: pytest.LogCaptureFixture
) -> None:
    got: list[tuple[int, ...]] = []
    enough = threading.Event()
    threads = set()

    def callback(time_s: float, words: tuple[int, ...]) -> None:
        threads.add(threading.current_thread().name)
        got.append(words)
        if len(got) == 3:
            enough.set()
        if len(got) == 1:
            raise RuntimeError("mine")

    subscription = link.subscribe([1, 2], divisor=10)
    subscription.on_publish(callback)
    for _ in range(3):
        device.publish(subscription.group)
    assert enough.wait(10)
    assert got == [(device.memory[1], device.memory[2])] * 3
    assert threads == {"unitylink callbacks"}
    assert "callback at" in caplog.text and "of <Subscription of 2 words" in caplog.text
    subscription.close()


def test_close_wakes_those_who_wait(link: Link, device: Any) -> None:
    asked = threading.Event()
    ends: list[BaseException] = []

    def silence(command: str, data: bytes) -> bytes:
        asked.set()
        return b""

    def read() -> None:
        try:
            link.read(1, timeout_s=60)
        except LinkError as error:
            ends.append(error)

    device.intercept = silence
    thread = threading.Thread(target=read)
    thread.start()
    assert asked.wait(10)
    link.close()
    thread.join(10)
    assert [type(error) for error in ends] == [LinkClosed]
    assert link.closed
    with pytest.raises(LinkClosed, match="closed by this program"):
        link.read(1)


def test_unplugged(link: Link, device: Any) -> None:
    subscription = link.subscribe([1], divisor=10)
    device.unplug()
    with pytest.raises(LinkClosed):
        subscription.wait(3600)
    with pytest.raises(LinkClosed, match=r"the other side closed the connection|Broken pipe"):
        link.read(1)
    subscription.close()


def test_busy(fake: ModuleType) -> None:
    device = fake.FakeDevice()
    device.intercept = lambda command, data: b"?busy\n"
    with pytest.raises(LinkBusy, match="the board serves another program"):
        connect(device.url())
    device.close()


@pytest.mark.parametrize(
    "url", ["", "x", "tcp:h:1", "fd:", "ftp://h:1", "fd:0?crc=maybe", "serial:?baud=1", "fd:0?x=1"]
)
def test_urls_that_mean_nothing(url: str) -> None:
    with pytest.raises(UrlError, match="link URL"):
        connect(url)


def test_ports_that_are_not_there() -> None:
    with pytest.raises(LinkNotFound, match="there is no such port"):
        connect("serial:/dev/no-such-port")
    with pytest.raises(LinkNotFound, match="nothing listens there"):
        connect("tcp://127.0.0.1:1")
    with pytest.raises(LinkNotFound, match="no descriptor"):
        connect("fd:1000000")


def test_nothing_is_left_open(fake: ModuleType) -> None:
    def one() -> None:
        device = fake.FakeDevice()
        with connect(device.url()) as link:
            link.subscribe([1], divisor=1).on_publish(lambda time_s, words: None)
        device.close()

    one()
    gc.collect()
    before = (len(os.listdir("/proc/self/fd")), threading.active_count())
    for _ in range(5):
        one()
    # What earlier tests left may end meanwhile, and may open something once more before that.
    for _ in range(200):
        gc.collect()
        after = (len(os.listdir("/proc/self/fd")), threading.active_count())
        if after[0] <= before[0] and after[1] <= before[1]:
            return
        time.sleep(0.02)
    raise AssertionError(f"files and threads: {before} before, {after} after")
