# SPDX-License-Identifier: BSD-3-Clause
"""Which gateware group carries what: the plan, and its start and stop."""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from unitylink.errors import DeviceMismatch, ValueRangeError

from .polling import Poller
from .publication import HARDWARE, SOFTWARE, Publication, PublishPlan, PublishReport, Taker, base_hz

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

    from .value import ReadValue


def plan(items: Iterable[tuple[ReadValue, int, int]], *, fallback: bool = False) -> list[PublishPlan]:
    """Allocate publishes: (value, mode, divisor) with the same link, mode and divisor share one, a snapshot.

    A gateware group that is full is continued in the next; where there are more than the gateware has, raise
    DeviceMismatch with the counts, or with `fallback` let the PC poll the rest.
    """
    shared: dict[tuple[Link, int, int], list[ReadValue]] = {}
    for value, mode, divisor in items:
        shared.setdefault((value.hardware.link, mode, divisor), []).append(value)
    plans: list[PublishPlan] = []
    used: dict[Link, int] = {}
    wanted: dict[Link, list[str]] = {}
    for (link, mode, divisor), values in shared.items():
        if mode == SOFTWARE:
            plans.append(PublishPlan(link, SOFTWARE, divisor, tuple(values)))
            continue
        configuration = link.configuration
        slowest = (1 << 8 * configuration.rate_bytes) - 1
        if divisor > slowest and configuration.publish_mode:
            if not fallback:
                raise DeviceMismatch(
                    f"{values[0].path}: {link.url} cannot publish at the base rate / {divisor}; its rates "
                    f"have {configuration.rate_bytes} byte(s), / {slowest} at most. Publish faster, poll it "
                    "with PUBLISH(2, ..), or start_publishing(fallback=True)"
                )
            plans.append(PublishPlan(link, SOFTWARE, divisor, tuple(values)))
            continue
        groups = configuration.groups if configuration.publish_mode else 0
        size = max(1, configuration.usable_group_size)
        parts = [tuple(values[i : i + size]) for i in range(0, len(values), size)]
        wanted.setdefault(link, []).append(
            f"{len(values)} values at {base_hz(link) / divisor:g} Hz need {len(parts)}"
        )
        for part in parts:
            used[link] = used.get(link, 0) + 1
            where = HARDWARE if used[link] <= groups else SOFTWARE
            plans.append(PublishPlan(link, where, divisor, part))
    for link, count in used.items():
        configuration = link.configuration
        groups = configuration.groups if configuration.publish_mode else 0
        if count > groups and not fallback:
            raise DeviceMismatch(
                f"{link.url} has {groups} publish groups of {configuration.usable_group_size} values, "
                f"{count} are needed ({'; '.join(wanted[link])}). "
                "Publish fewer rates, poll some with PUBLISH(2, ..), or "
                "start_publishing(fallback=True)"
            )
    return plans


class Publisher:
    """Run the publishes of one tree of values.

    >>> publisher.start()                                  # doctest: +SKIP
    >>> [(r.rate_hz, r.received) for r in publisher.reports()]   # doctest: +SKIP
    [(100.0, 42)]
    """

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._items: dict[ReadValue, tuple[int, int]] = {}  # value -> (mode, divisor)
        self._running: list[Publication] = []
        self._takers: tuple[Taker, ...] = ()
        self._fallback = False

    @property
    def active(self) -> bool:
        return bool(self._running)

    def add(self, value: ReadValue) -> None:
        """Plan a value as its spec says; it is published from the next start on."""
        if value.publish is not None:
            self._items[value] = value.publish

    def require(self, value: ReadValue, rate_hz: float | None = None) -> None:
        """Make sure that a value is published, polled at `rate_hz` where the spec has no PUBLISH for it."""
        self.demand(value, rate_hz)
        with self._lock:
            missing = not any(value in publication.plan.values for publication in self._running)
            fallback = self._fallback
        if missing:
            self.stop()
            self.start(fallback=fallback)

    def demand(self, value: ReadValue, rate_hz: float | None = None) -> None:
        """Plan a value as `require` does, without starting yet; ValueRangeError where it has no rate."""
        if value.publish is not None:
            if rate_hz is not None:
                raise ValueRangeError(f"{value.path}: the spec gives its rate by PUBLISH; leave rate_hz out")
        elif rate_hz is not None:
            base = base_hz(value.hardware.link)
            if not 0 < rate_hz <= base:
                raise ValueRangeError(
                    f"{value.path}: rate_hz {rate_hz} is not above 0 and at most {base} Hz (the base rate)"
                )
            with self._lock:
                self._items[value] = (SOFTWARE, round(base / rate_hz))
        elif value not in self._items:
            raise ValueRangeError(
                f"{value.path} has no PUBLISH in the spec; add one, or give rate_hz to have it polled"
            )

    def start(self, *, fallback: bool = False) -> None:
        """Start all planned publishes; with `fallback` poll what the gateware has no room for."""
        failed: list[Publication] = []
        try:
            with self._lock:
                if self._running:
                    return
                self._fallback = fallback
                items = [(value, mode, divisor) for value, (mode, divisor) in self._items.items()]
                try:
                    for item in plan(items, fallback=fallback):
                        self._running.append(self._launch(item))
                except BaseException:
                    failed, self._running = self._running, []
                    raise
        finally:
            # Not under the lock: closing a poll waits for its callback, which may want the lock.
            for publication in failed:
                publication.close()

    def _launch(self, item: PublishPlan) -> Publication:
        if item.mode == HARDWARE:
            publication = Publication(item, self._current_takers)
            verify = all(value.hardware.repeatable_reads for value in item.values)
            try:
                subscription = item.link.subscribe(item.addresses, divisor=item.divisor, verify=verify)
            except DeviceMismatch:  # another user of the link holds the groups
                if not self._fallback:
                    raise
                item = PublishPlan(item.link, SOFTWARE, item.divisor, item.values)
            else:
                publication.source = subscription
                subscription.on_publish(publication.deliver)
                return publication
        publication = Publication(item, self._current_takers)
        publication.source = Poller(item, publication.deliver)
        return publication

    def stop(self) -> None:
        """Stop all publishes; no callback starts after this returns (one that calls stop finishes)."""
        with self._lock:
            running, self._running = self._running, []
        for publication in running:
            publication.close()

    @contextmanager
    def running(self, *, fallback: bool = False) -> Iterator[Publisher]:
        """Publish within a `with` block."""
        self.start(fallback=fallback)
        try:
            yield self
        finally:
            self.stop()

    def reports(self) -> list[PublishReport]:
        """Say what each running publish has done so far."""
        with self._lock:
            return [publication.report() for publication in self._running]

    def take_with(self, taker: Taker) -> None:
        """Hand every publish to `taker(time_s, values, numbers)` from now on."""
        with self._lock:
            self._takers += (taker,)

    def take_no_more(self, taker: Taker) -> None:
        with self._lock:
            self._takers = tuple(t for t in self._takers if t != taker)

    def _current_takers(self) -> tuple[Taker, ...]:
        return self._takers
