# SPDX-License-Identifier: BSD-3-Clause
"""Which gateware group carries which values: the plan, its start and its stop."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from unitylink.errors import DeviceMismatch, ValueRangeError
from unitylink.layer3_hardware.arguments import positive
from unitylink.spec.expand.publishing import split
from unitylink.spec.model import Publish

from .polling import Poller
from .publication import (
    HARDWARE,
    SOFTWARE,
    ArraysTaker,
    Publication,
    PublishPlan,
    PublishReport,
    Taker,
    Takers,
    base_hz,
)
from .published import PublishedValue

if TYPE_CHECKING:
    from unitylink.layer2_message import Link


def plan(items: Iterable[tuple[PublishedValue, Publish]], *, fallback: bool = False) -> list[PublishPlan]:
    """Assign values to publishes. Values with the same link, mode, trigger, rate and group name share one.

    The values of one publish are one snapshot. When a gateware group is full, the next one takes the rest. If
    the gateware has too few groups, raise DeviceMismatch with the counts. With `fallback`, let the PC poll
    the rest. Publishes on events come first, because each of them needs the group of its event line.
    """
    shared: dict[tuple[Link, int, str, int, str, str], list[PublishedValue]] = {}
    for value, publish in items:
        key = (publish.mode, publish.trigger, publish.divisor, publish.event, publish.group)
        shared.setdefault((value.hardware.link, *key), []).append(value)
    plans: list[PublishPlan] = []
    allocations: dict[Link, _Allocation] = {}
    # False is before True, so events come first
    for (link, mode, trigger, divisor, event, group), values in sorted(
        shared.items(), key=lambda item: item[0][2] == "rate"
    ):
        publish = Publish(mode, divisor, None, trigger, event, group)
        if mode == SOFTWARE:
            plans.append(PublishPlan(link, publish, tuple(values)))
            continue
        allocation = allocations.setdefault(link, _Allocation(link))
        plans += allocation.plans(publish, values, fallback)
    for allocation in allocations.values():
        allocation.check(fallback)
    return plans


class _Allocation:
    """The groups of one gateware that are already assigned."""

    def __init__(self, link: Link) -> None:
        configuration = link.configuration
        self.link = link
        self.used = 0
        self.groups = configuration.groups if configuration.publish_mode else 0
        self.size = max(1, configuration.usable_group_size)
        self.slowest = (1 << 8 * configuration.rate_bytes) - 1 if configuration.publish_mode else None
        self.wanted: list[str] = []

    def plans(self, publish: Publish, values: list[PublishedValue], fallback: bool) -> list[PublishPlan]:
        link = self.link
        if self.slowest is not None and publish.divisor > self.slowest:
            if not fallback:
                raise DeviceMismatch(
                    f"{values[0].path}: {link.url} cannot publish at the base rate / {publish.divisor}; its "
                    f"rates have {link.configuration.rate_bytes} byte(s), / {self.slowest} at most. Publish "
                    "faster, poll it with PUBLISH(2, ..), or start_publishing(fallback=True)"
                )
            return [PublishPlan(link, publish, tuple(values)).polled()]
        parts = self._parts(values)
        clocked = publish.trigger == "rate"
        how = f"at {base_hz(link) / publish.divisor:g} Hz" if clocked else f"on {publish.event or 'change'}"
        self.wanted.append(f"{len(values)} values {how} need {len(parts)}")
        made = []
        for part in parts:
            item = PublishPlan(link, publish, part, None if clocked else part[0].line)
            self.used += 1
            if self.used > self.groups and clocked:
                item = item.polled()
            made.append(item)
        if not clocked and (len(parts) > 1 or self.used > self.groups):
            raise DeviceMismatch(
                f"{values[0].path}: {len(values)} values {how} do not fit a group of {link.url}, which has "
                f"{self.groups} of {self.size} words; and values on an event cannot be polled"
            )
        return made

    def _parts(self, values: list[PublishedValue]) -> list[tuple[PublishedValue, ...]]:
        for value in values:
            if (words := value.codec.words) > self.size:
                raise DeviceMismatch(
                    f"{value.path} takes {words} words, a group of {self.link.url} has {self.size}; "
                    "poll it with PUBLISH(2, ..)"
                )
        return split(values, lambda value: value.codec.words, self.size)

    def check(self, fallback: bool) -> None:
        if self.used > self.groups and not fallback:
            raise DeviceMismatch(
                f"{self.link.url} has {self.groups} publish groups of {self.size} values, "
                f"{self.used} are needed ({'; '.join(self.wanted)}). "
                "Publish fewer rates, poll some with PUBLISH(2, ..), or "
                "start_publishing(fallback=True)"
            )


def _read(item: PublishPlan) -> tuple[int, ...]:
    """Read the words of values that are published on change, before their first publish."""
    atomic = 1 < len(item.addresses) <= item.link.configuration.read_many
    words = item.link.read_many(item.addresses, atomic=atomic, checked=item.checked)
    return tuple(words.tolist())


DIVISOR_MAX = 0xFFFFFFFF  # divisor of the base rate, with the same limit as in the gateware
RING, RING_MOST, RING_S = 4096, 1 << 17, 0.25  # publishes that may wait while the program is busy


class Publisher:
    """Run the publishes of one tree of values.

    With `gather_s`, publishes may be delivered so much later, several at a time. Each keeps its own time.

    >>> publisher.start()                                  # doctest: +SKIP
    >>> [(r.rate_hz, r.received) for r in publisher.reports()]   # doctest: +SKIP
    [(100.0, 42)]
    """

    def __init__(self, *, gather_s: float = 0.0) -> None:
        self._gather_s = gather_s
        self._lock = threading.RLock()
        self._items: dict[PublishedValue, Publish] = {}
        self._running: list[Publication] = []
        self._takers: Takers = ()
        self._fallback = False

    @property
    def active(self) -> bool:
        return bool(self._running)

    def add(self, value: PublishedValue) -> None:
        """Plan a value as its spec says. It is published from the next start on."""
        if value.publish is not None:
            self._items[value] = value.publish

    def require(self, value: PublishedValue, rate_hz: float | None = None) -> None:
        """Make sure that a value is published. Without a PUBLISH in the spec, it is polled at `rate_hz`."""
        self.demand(value, rate_hz)
        with self._lock:
            missing = not any(value in publication.plan.values for publication in self._running)
            fallback = self._fallback
        if missing:
            self.stop()
            self.start(fallback=fallback)

    def planned(self, value: PublishedValue) -> Publish:
        """Return how a requested value is published."""
        with self._lock:
            return self._items[value]

    def newest(self, value: PublishedValue) -> tuple[float, Any] | None:
        """Return the time and value of the last publish on change. Return None if there was none."""
        with self._lock:
            for publication in self._running:
                if value in publication.plan.values and publication.newest is not None:
                    time_s, numbers = publication.newest
                    return time_s, numbers[publication.plan.values.index(value)]
        return None

    def demand(self, value: PublishedValue, rate_hz: float | None = None) -> None:
        """Plan a value as `require` does, without starting yet. Raises ValueRangeError if it has no rate."""
        if value.publish is not None:
            if rate_hz is not None:
                raise ValueRangeError(f"{value.path}: the spec gives its rate by PUBLISH; leave rate_hz out")
        elif rate_hz is not None:
            base = base_hz(value.hardware.link)
            rate_hz = positive(f"{value.path}: rate_hz", rate_hz)
            if not base / DIVISOR_MAX <= rate_hz <= base:
                raise ValueRangeError(
                    f"{value.path}: rate_hz {rate_hz:g} is not above 0 and at most {base} Hz (the base rate)"
                )
            with self._lock:
                self._items[value] = Publish(SOFTWARE, round(base / rate_hz))
        elif value not in self._items:
            raise ValueRangeError(
                f"{value.path} has no PUBLISH in the spec; add one, or give rate_hz to have it polled"
            )

    def start(self, *, fallback: bool = False) -> None:
        """Start all planned publishes.

        With `fallback`, the PC polls those for which the gateware has no room.
        """
        failed: list[Publication] = []
        try:
            with self._lock:
                if self._running:
                    return
                self._fallback = fallback
                items = list(self._items.items())
                try:
                    for item in plan(items, fallback=fallback):
                        item.link.call_on_reset(self._pause)
                        self._running.append(self._launch(item))
                except BaseException:
                    failed, self._running = self._running, []
                    raise
        finally:
            # Not under the lock, because closing a poll waits for its callback, and that may want the lock.
            for publication in failed:
                publication.close()

    def _launch(self, item: PublishPlan) -> Publication:
        if item.mode == HARDWARE:
            publication = Publication(item, self._takers)
            began_s = item.link.now_s()
            try:
                subscription = item.link.subscribe(
                    item.addresses,
                    divisor=item.divisor,
                    on_event=not item.divisor,
                    verify=item.repeatable,
                    ring=min(max(RING, round(item.rate_hz * RING_S)), RING_MOST),
                    group=item.number,
                )
            except DeviceMismatch:  # another user of the link has taken the groups
                if not self._fallback or not item.divisor:
                    raise
                item = item.polled()
            else:
                publication.source = subscription
                try:
                    first = (
                        (began_s, _read(item))
                        if item.publish.trigger == "change" and item.repeatable
                        else None
                    )
                except BaseException:
                    publication.close()
                    raise
                subscription.on_publish(
                    publication.deliver,
                    gather_s=self._gather_s,
                    arrays=publication.deliver_arrays,
                    first=first,
                )
                return publication
        publication = Publication(item, self._takers)
        publication.source = Poller(item, publication.deliver)
        return publication

    def stop(self) -> None:
        """Stop all publishes.

        No callback starts after this returns. A callback that calls stop runs to its end.
        """
        with self._lock:
            running, self._running = self._running, []
        for publication in running:
            publication.close()

    def _pause(self) -> Callable[[], None]:
        """Stop, and return what goes on afterwards."""
        if not self._running:
            return lambda: None
        self.stop()
        return lambda: self.start(fallback=self._fallback)

    @contextmanager
    def running(self, *, fallback: bool = False) -> Iterator[Publisher]:
        """Publish within a `with` block."""
        self.start(fallback=fallback)
        try:
            yield self
        finally:
            self.stop()

    def reports(self) -> list[PublishReport]:
        """Return what each running publish has done so far."""
        with self._lock:
            return [publication.report() for publication in self._running]

    def take_with(self, taker: Taker, arrays: ArraysTaker | None = None) -> None:
        """Give every publish to `taker(time_s, values, numbers, raws)` from now on.

        With `arrays` it may instead get many at once: `arrays(times, values, raws)`.
        """
        with self._lock:
            self._hand_to((*self._takers, (taker, arrays)))

    def take_no_more(self, taker: Taker) -> None:
        with self._lock:
            self._hand_to(tuple(pair for pair in self._takers if pair[0] != taker))

    def _hand_to(self, takers: Takers) -> None:
        self._takers = takers
        for publication in self._running:
            publication.takers = takers
