# SPDX-License-Identifier: BSD-3-Clause
"""How a link ends: by close() in any thread, by Ctrl-C, at exit, in a forked child, or forgotten."""

from __future__ import annotations

import gc
import os
import signal
import threading
import warnings
from types import ModuleType
from typing import Any

import pytest

from unitylink import Link, LinkClosed, connect

HOURS_S = 3600.0


def test_close_does_not_wait_for_those_who_wait(link: Link, device: Any) -> None:
    asked = threading.Event()
    ends: list[BaseException] = []

    def silence(command: str, data: bytes) -> bytes:
        asked.set()
        return b""

    def read() -> None:
        try:
            link.read(1, timeout_s=HOURS_S)
        except LinkClosed as error:
            ends.append(error)

    link.subscribe([1], divisor=10)  # so that closing sends something to the device
    device.intercept = silence
    thread = threading.Thread(target=read)
    thread.start()
    assert asked.wait(10)
    link.close()
    thread.join(10)
    assert len(ends) == 1


def test_ctrl_c_ends_a_long_wait_and_nothing_else(link: Link, device: Any) -> None:
    def interrupt(command: str, data: bytes) -> bytes:
        os.kill(os.getpid(), signal.SIGINT)
        return b""

    for request in (
        lambda: link.read(1, timeout_s=HOURS_S),
        lambda: link.write(1, 2, timeout_s=HOURS_S),
        lambda: link.read_each(range(8), timeout_s=HOURS_S),
    ):
        device.intercept = interrupt
        with pytest.raises(KeyboardInterrupt):
            request()
        device.intercept = lambda command, data: None
        assert link.read(5) == device.memory[5]
    assert not link.closed


def test_ctrl_c_ends_the_opening_of_a_silent_device(fake: ModuleType) -> None:
    def interrupt(command: str, data: bytes) -> bytes:
        os.kill(os.getpid(), signal.SIGINT)
        return b""

    device = fake.FakeDevice()
    device.intercept = interrupt
    with pytest.raises(KeyboardInterrupt):
        connect(device.url(f"timeout={HOURS_S}"))
    device.close()


def test_ctrl_c_ends_the_wait_for_a_publish(link: Link, device: Any) -> None:
    subscription = link.subscribe([1], divisor=10)
    interrupter = threading.Thread(target=os.kill, args=(os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):  # before or during the wait
        interrupter.start()
        subscription.wait(HOURS_S)
    interrupter.join()


def test_ctrl_c_leaves_the_requests_of_other_threads_alone(link: Link, device: Any) -> None:
    first = threading.Event()
    got: list[int] = []

    def intercept(command: str, data: bytes) -> bytes | None:
        if command == "R" and data[0] == 1:
            first.set()
            return b""
        return None

    def interrupt_when_both_wait() -> None:
        got.append(link.read(2, timeout_s=HOURS_S))  # this waits behind the request that is never answered

    device.intercept = intercept
    other = threading.Thread(target=interrupt_when_both_wait)

    def begin() -> None:
        assert first.wait(10)
        other.start()
        os.kill(os.getpid(), signal.SIGINT)

    starter = threading.Thread(target=begin)
    starter.start()
    with pytest.raises(KeyboardInterrupt):
        link.read(1, timeout_s=HOURS_S)
    starter.join(10)
    other.join(10)
    assert got == [device.memory[2]]


def test_a_signal_handler_that_returns_changes_nothing(link: Link, device: Any) -> None:
    heard: list[int] = []
    before = signal.signal(signal.SIGUSR1, lambda number, frame: heard.append(link.read(7)))

    def answer_late(command: str, data: bytes) -> bytes | None:
        if command == "R" and data[0] == 1 and not heard:
            device.intercept = lambda command, data: None
            os.kill(os.getpid(), signal.SIGUSR1)
            return b""  # the first attempt gets no answer; meanwhile the handler reads
        return None

    device.intercept = answer_late
    try:
        assert link.read(1, timeout_s=0.5) == device.memory[1]
    finally:
        signal.signal(signal.SIGUSR1, before)
    assert heard == [device.memory[7]]


def test_a_forgotten_link_closes_itself_and_says_so(fake: ModuleType) -> None:
    device = fake.FakeDevice()
    link = connect(device.url())
    subscription = link.subscribe([1], divisor=1)
    link.self = link  # type: ignore[attr-defined]
    del link
    gc.collect()
    device.publish(0)
    assert subscription.wait(10)  # a subscription keeps its link alive
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        del subscription
        gc.collect()
    assert [str(warning.message)[:16] for warning in caught] == ["unclosed <Link f"]
    assert device.log[-1] == "DPS"
    device.close()
