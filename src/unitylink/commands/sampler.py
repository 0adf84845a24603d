# SPDX-License-Identifier: BSD-3-Clause
"""Samples of items: published by the gateware if the spec says so, or else read by the PC."""

from __future__ import annotations

import logging
import queue
import time
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any, NoReturn

from unitylink.errors import LinkClosed, LinkError, LinkTimeout, ValueRangeError
from unitylink.layer4_data import Publisher, ReadValue
from unitylink.layer4_data.publication import base_hz
from unitylink.layer4_data.published import PublishedValue
from unitylink.recording.reorder_buffer import ReorderBuffer

from .item_values import item_values
from .names import Item

if TYPE_CHECKING:
    from types import TracebackType

    from typing_extensions import Self

    from unitylink.layer2_message import Link, LinkEvent

Sample = tuple[float, Sequence[PublishedValue], Sequence[Any]]  # host time in s, values, their numbers

_log = logging.getLogger("unitylink.commands")
_BECAME = {
    "lost": "the line was lost, and is being opened again",
    "restarted": "the device has restarted: the values written to it are lost",
    "back": "the line is back, and the samples go on",
}
TICK_S = 0.1  # s between two checks of the link and of the time
_WAITING = 100_000  # samples that may wait; more are lost, and counted


class Sampler:
    """Publish `items` while the `with` block runs, and hand out their samples.

    With `gather_s`, the samples of that time are handed out together, each with its own time. Waking a thread
    for every sample costs more than its work. With `hold_s`, they are handed out so much later, in the order
    of their times. Otherwise, samples of different rates, and those that the PC reads, are not in this order.
    A sample that is even later has lost its place, and counts as lost.

    `start_s` is the time of the link at which sampling began.

    >>> with Sampler(link, items, rate_hz=10) as sampler:          # doctest: +SKIP
    ...     for sample in sampler.samples(count=100):
    ...         print(sample)
    """

    def __init__(
        self,
        link: Link,
        items: Sequence[Item],
        rate_hz: float,
        *,
        gather_s: float = 0.0,
        hold_s: float = 0.0,
    ) -> None:
        self.publisher = Publisher(gather_s=gather_s)
        self.lost = 0
        self.start_s = 0.0
        self._link = link
        self._gather_s = gather_s
        self._held = ReorderBuffer[Sample](hold_s)
        self._enough = False  # true when the requested number of samples has come
        self._arrived: queue.SimpleQueue[Sample] = queue.SimpleQueue()
        self._asked = next((item.address for item in items if item.pollable), None)
        for value in item_values(link, items, self.publisher).values():
            if value.publish is None:
                self._demand(value, rate_hz)
        self.publisher.take_with(self._take)

    def _demand(self, value: ReadValue[Any], rate_hz: float) -> None:
        try:
            self.publisher.demand(value, rate_hz)
        except ValueRangeError:
            base = base_hz(self._link)
            raise ValueRangeError(f"--rate {rate_hz:g}: {self._link.url} takes {base} Hz at most") from None

    def _take(
        self, time_s: float, values: Sequence[PublishedValue], numbers: Sequence[Any], _: Sequence[int]
    ) -> None:
        if self._arrived.qsize() < _WAITING:
            self._arrived.put((time_s, values, numbers))
        else:
            self.lost += 1

    def __enter__(self) -> Self:
        self.start_s = self._link.now_s()
        self._link.on_event(self._tell)
        self.publisher.start(fallback=True)
        reports = self.publisher.reports()
        if len(reports) == 1 and reports[0].rate_hz:
            self._held.hold_s = 0.0  # samples of one clock come in order
        return self

    def _tell(self, event: LinkEvent) -> None:
        _log.warning("%s: %s (%s)", self._link.url, _BECAME[event.kind], event.text)

    def since_start_s(self, time_s: float) -> float:
        """Return the seconds from the start to the time of a sample.

        The PC knows the device's clock only to some microseconds. So the first sample may be before the
        start. Then the time of the sample is taken as the start.
        """
        self.start_s = min(self.start_s, time_s)
        return time_s - self.start_s

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.lost += sum(report.lost for report in self.publisher.reports())
        try:
            self.publisher.stop()
        except LinkError:
            if error is None:  # otherwise the first error says more than the failed stop
                raise

    def samples(self, count: int | None = None, duration_s: float | None = None) -> Iterator[Sample | None]:
        """Yield samples until there were `count` or `duration_s` is over. Yield None at least every 0.1 s.

        Raises LinkClosed if the device goes away, and LinkTimeout if it falls silent.
        """
        slowest_hz = min(report.rate_hz for report in self.publisher.reports())
        patience_s = 2.0 + 3.0 / slowest_hz if slowest_hz else float("inf")  # an event may never come
        last = time.monotonic()
        end = last + duration_s if duration_s is not None else float("inf")
        taken = 0
        while time.monotonic() < end:
            sample = self._next(min(TICK_S, end - time.monotonic()))
            yield sample
            if sample is not None:
                last = time.monotonic()
                taken += 1
                if taken == count:
                    self._enough = True
                    return
            elif self._link.closed:
                yield from self.rest()
                self._raise_closed()
            elif self._link.trouble:  # the link is being opened again (reconnect=1), however long that takes
                last = time.monotonic()
            elif time.monotonic() - last > patience_s:
                self._raise_silent(patience_s)
        yield from self.rest()

    def rest(self) -> Iterator[Sample]:
        """Yield the samples that have not been handed out yet. This is for the end, also after Ctrl-C."""
        self._hold_arrived()
        while not self._enough and (sample := self._held.take_last()) is not None:
            yield sample

    def _raise_closed(self) -> NoReturn:
        try:
            self._link.check_alive()
        except LinkClosed as error:
            reason = error.message.removeprefix("the link is closed ")
            raise LinkClosed(f"{self._link.url}: the device went away {reason}") from error
        raise LinkClosed(f"{self._link.url}: the device went away")

    def _raise_silent(self, waited_s: float) -> NoReturn:
        """Raise an error that says whether the device is silent, or only its publishes."""
        silence = f"{self._link.url}: no sample for {waited_s:.1f} s"
        if self._asked is None:
            raise LinkTimeout(f"{silence}; does the device publish?")
        try:
            self._link.read(self._asked)
        except LinkClosed:
            self._raise_closed()
        except LinkTimeout as error:
            raise LinkTimeout(
                f"{silence}, and a read is not answered either; is the device still there?"
            ) from error
        except LinkError as error:
            raise LinkTimeout(f"{silence}; a read ends with: {error}") from error
        raise LinkTimeout(f"{silence}; the device answers, but publishes nothing")

    def _next(self, wait_s: float) -> Sample | None:
        due_s = self._held.due_s(self._link.now_s())
        if self._gather_s and self._arrived.empty() and (due_s is None or due_s > 0):
            time.sleep(max(0.0, min(self._gather_s, wait_s)))
            wait_s -= self._gather_s
        until = time.monotonic() + wait_s
        while True:
            self._hold_arrived()
            now_s = self._link.now_s()
            sample = self._held.take(now_s)
            left_s = until - time.monotonic()
            if sample is not None or left_s <= 0:
                return sample
            due_s = self._held.due_s(now_s)
            with suppress(queue.Empty):
                self._hold(self._arrived.get(timeout=left_s if due_s is None else min(left_s, due_s)))

    def _hold_arrived(self) -> None:
        for _ in range(self._arrived.qsize()):
            self._hold(self._arrived.get())

    def _hold(self, sample: Sample) -> None:
        self.lost += not self._held.put(sample[0], sample)
