# SPDX-License-Identifier: BSD-3-Clause
"""Events of the gateware as an interrupt of the processor, through Linux's UIO."""

from __future__ import annotations

import asyncio
import os
import select
import time
from types import TracebackType
from typing import TYPE_CHECKING

from unitylink.errors import LinkError, LinkNotFound, LinkTimeout

from .proxy import HardwareProxy

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

PENDING, ENABLE = 0, 1  # relative addresses
_COUNT_BYTES = 4  # the kernel gives the number of interrupts so far
_UNMASK = (1).to_bytes(_COUNT_BYTES, "little")


class InterruptProxy(HardwareProxy):
    """Wait for events of an `interrupt_slave`: +0 pending (a write clears), +1 enable.

    `device` is the UIO device whose interrupt the gateware raises. It may be the one that the link maps. No
    event is lost. One that comes while another is handled stays pending, and the next wait returns at once.

    >>> with InterruptProxy(link, 0x80, "/dev/uio0") as events:   # doctest: +SKIP
    ...     events.enable(0b101)
    ...     while True:
    ...         print(bin(events.wait(timeout_s=1.0)))

    Raises LinkNotFound without such a device.
    """

    kind = "interrupt"

    def __init__(self, link: Link, base: int, device: str) -> None:
        super().__init__(link, base, words=2)
        self.device = device
        try:
            self._file = os.open(device, os.O_RDWR | os.O_NONBLOCK)
        except OSError as error:
            raise LinkNotFound(
                f"{device}: {error.strerror}; see /sys/class/uio for the devices there are, and "
                "`ls -l` for who may use them"
            ) from error

    def enable(self, lines: int) -> None:
        """Let the events of these lines interrupt.

        Each bit of `lines` is a line. All other events are only remembered.
        """
        self.write(ENABLE, lines)

    def wait(self, timeout_s: float | None = None) -> int:
        """Return the enabled events since the last wait, one bit for each, and clear them.

        Raises LinkTimeout if none comes within `timeout_s`. With None, it waits for ever.
        """
        end = _end(timeout_s)
        while not (events := self._take()):
            self._unmask()
            if not select.select([self._file], [], [], _left(end))[0]:
                raise self._late(timeout_s)
            self._count()
        return events

    async def wait_async(self, timeout_s: float | None = None) -> int:
        """Return what `wait` does, without holding up other tasks."""
        loop, end = asyncio.get_running_loop(), _end(timeout_s)
        while not (events := self._take()):
            came = asyncio.Event()
            loop.add_reader(self._file, came.set)
            try:
                self._unmask()
                await asyncio.wait_for(came.wait(), _left(end))
            except asyncio.TimeoutError:
                raise self._late(timeout_s) from None
            finally:
                loop.remove_reader(self._file)
            self._count()
        return events

    def close(self) -> None:
        """Close the device. A wait after it raises LinkError."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def __enter__(self) -> InterruptProxy:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def _take(self) -> int:
        if self._file < 0:
            raise LinkError(f"{self.device}: the interrupt was closed")
        events = self.read(PENDING) & self.read(ENABLE)
        if events:
            self.write(PENDING, events)
        return events

    def _unmask(self) -> None:
        """Allow one more interrupt, because the kernel masks it each time."""
        try:
            os.write(self._file, _UNMASK)
        except OSError as error:
            raise LinkError(f"{self.device}: it cannot be unmasked: {error.strerror}") from error

    def _count(self) -> None:
        """Read the kernel's count, so that the next wait really waits."""
        try:
            told = os.read(self._file, _COUNT_BYTES)
        except BlockingIOError:
            return  # another reader was faster
        except OSError as error:
            raise LinkError(f"{self.device}: {error.strerror}") from error
        if len(told) < _COUNT_BYTES:
            raise LinkError(f"{self.device}: the device is gone")

    def _late(self, timeout_s: float | None) -> LinkTimeout:
        return LinkTimeout(f"{self.device}: no enabled event within {timeout_s} s")


def _end(timeout_s: float | None) -> float | None:
    return None if timeout_s is None else time.monotonic() + timeout_s


def _left(end: float | None) -> float | None:
    return None if end is None else max(0.0, end - time.monotonic())
