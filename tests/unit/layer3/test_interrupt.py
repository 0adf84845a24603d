# SPDX-License-Identifier: BSD-3-Clause
"""Waiting for an interrupt, over a fake UIO device: a pseudo-terminal whose other end is the kernel."""

from __future__ import annotations

import asyncio
import os
import threading
import tty
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

from unitylink.errors import LinkError, LinkNotFound, LinkTimeout
from unitylink.layer3_hardware import InterruptProxy

BASE = 0x80


class Kernel:
    """`interrupt_slave` and UIO: an interrupt is told once for each time that it was unmasked."""

    def __init__(self) -> None:
        self.pending, self.enabled, self.told = 0, 0, 0
        self.masked = True
        self.guard = threading.Lock()
        self.end, device = os.openpty()
        tty.setraw(device)
        self.name, self._device = os.ttyname(device), device
        self.unmasked = threading.Semaphore(0)
        self._thread = threading.Thread(target=self._serve)
        self._thread.start()

    def read(self, address: int) -> int:
        return self.pending if address == 0 else self.enabled

    def write(self, address: int, word: int) -> None:
        with self.guard:
            if address == 0:
                self.pending &= ~word
            else:
                self.enabled = word

    def event(self, lines: int) -> None:
        with self.guard:
            self.pending |= lines
            self._raise()

    def close(self) -> None:
        if self.end >= 0:
            os.write(self._device, b"stop")
            self._thread.join()
            os.close(self.end)
            os.close(self._device)
            self.end = -1

    def _serve(self) -> None:
        while (said := os.read(self.end, 4)) != b"stop":
            assert said == b"\x01\0\0\0"
            with self.guard:
                self.masked = False
                self._raise()
            self.unmasked.release()

    def _raise(self) -> None:
        if not self.masked and self.pending & self.enabled:
            self.masked = True
            self.told += 1
            os.write(self.end, self.told.to_bytes(4, "little"))


@pytest.fixture
def kernel() -> Iterator[Kernel]:
    kernel = Kernel()
    yield kernel
    kernel.close()


@pytest.fixture
def events(fake: ModuleType, kernel: Kernel) -> Iterator[InterruptProxy]:
    with InterruptProxy(fake.FakeLink(kernel, base=BASE), BASE, kernel.name) as events:
        yield events


def test_what_is_pending_is_returned_at_once_and_cleared(kernel: Kernel, events: InterruptProxy) -> None:
    events.enable(0b101)
    kernel.event(0b111)
    assert events.wait(timeout_s=0) == 0b101
    assert kernel.pending == 0b010  # not enabled: remembered
    assert kernel.told == 0
    events.enable(0b010)
    assert events.wait(timeout_s=0) == 0b010


def test_an_interrupt_ends_the_wait(kernel: Kernel, events: InterruptProxy) -> None:
    events.enable(0b11)
    found: list[int] = []
    waiter = threading.Thread(target=lambda: found.append(events.wait()))
    waiter.start()
    kernel.unmasked.acquire()  # it waits now
    kernel.event(0b10)
    waiter.join()
    assert found == [0b10] and kernel.pending == 0 and kernel.told == 1


def test_every_event_of_many_is_seen(kernel: Kernel, events: InterruptProxy) -> None:
    events.enable(0xFF)
    seen = 0
    for line in range(8):
        threading.Thread(target=kernel.event, args=(1 << line,)).start()
        if not seen & 1 << line:
            seen |= events.wait()
    assert seen == 0xFF and kernel.pending == 0


def test_a_task_waits(kernel: Kernel, events: InterruptProxy) -> None:
    events.enable(1)

    async def main() -> int:
        waiting = asyncio.create_task(events.wait_async())
        await asyncio.to_thread(kernel.unmasked.acquire)
        kernel.event(1)
        return await waiting

    assert asyncio.run(main()) == 1
    with pytest.raises(LinkTimeout, match="no enabled event within 0 s"):
        asyncio.run(events.wait_async(timeout_s=0))


def test_no_event_is_a_timeout(kernel: Kernel, events: InterruptProxy) -> None:
    events.enable(1)
    kernel.event(2)
    with pytest.raises(LinkTimeout, match="no enabled event within 0 s"):
        events.wait(timeout_s=0)


def test_a_count_that_was_left_over_wakes_nobody_twice(kernel: Kernel, events: InterruptProxy) -> None:
    events.enable(1)
    kernel.masked = False
    kernel.event(1)  # told, and taken before anybody waited
    assert events.wait(timeout_s=0) == 1
    with pytest.raises(LinkTimeout):
        events.wait(timeout_s=0)


def test_a_device_that_is_not_there_or_gone(
    fake: ModuleType, tmp_path: Path, kernel: Kernel, events: InterruptProxy
) -> None:
    with pytest.raises(LinkNotFound, match="uio9: No such file or directory; see /sys/class/uio"):
        InterruptProxy(fake.FakeLink(kernel, base=BASE), BASE, str(tmp_path / "uio9"))
    kernel.close()
    with pytest.raises(LinkError, match="cannot be unmasked: Input/output error"):
        events.wait(timeout_s=0)
    events.close()
    events.close()
    with pytest.raises(LinkError, match="the interrupt was closed"):
        events.wait()
