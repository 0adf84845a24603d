# SPDX-License-Identifier: BSD-3-Clause
"""Several values with one write, one consistent snapshot and one callback."""

from __future__ import annotations

import asyncio
import re
import threading
from collections.abc import AsyncIterator, Callable, Coroutine, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar, cast

from unitylink.errors import (
    AssignmentError,
    DeviceMismatch,
    LinkError,
    UnexpectedValue,
    UnknownName,
    ValueRangeError,
    shown,
)

from .assignment import refuse
from .at_once import at_once
from .cycle import Cycle
from .html import values_html
from .listeners import Listeners
from .portions import Reading, any_checked, burst_of, portions
from .publication import join
from .published import PublishedValue
from .read_value import ReadValue
from .sets import Sets
from .snapshot import Snapshot
from .sole import Burst, SoleLink
from .value import Value
from .write_value import WriteValue

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer3_hardware import HardwareProxy

R = TypeVar("R")
Writes = dict["HardwareProxy", list[tuple[WriteValue[Any], int]]]  # values and their raw numbers


class ValueGroup:
    """Several values: `snapshot` reads the READs together, `write` lets the WRITEs take effect together.

    `values` is a mapping from key to value, or a sequence of values, whose keys are then their paths. The
    values may be on any number of links.

    >>> targets = ValueGroup([robot.j1.pos_sp, robot.j2.pos_sp])         # doctest: +SKIP
    >>> targets.write([100, -200])                                       # doctest: +SKIP
    >>> targets.write({"j1.pos_sp": 100}); targets.write(j2_pos_sp=-200) # doctest: +SKIP
    """

    def __init__(self, values: Mapping[str, Value[Any]] | Iterable[Value[Any]], path: str = "group") -> None:
        self.path = path
        try:
            items = values.items() if isinstance(values, Mapping) else [(None, value) for value in values]
        except TypeError:
            raise ValueRangeError(f"{path}: {shown(values)} are not values of a robot") from None
        for _, value in items:
            if not isinstance(value, Value):
                raise ValueRangeError(f"{path}: {shown(value)} is not a value of a robot")
        pairs = [(value.path if key is None else key, value) for key, value in items]
        self.values: dict[str, Value[Any]] = {}
        for key, value in pairs:
            if key in self.values:
                raise ValueRangeError(f"{path}: two values are called {key}; give a mapping with other keys")
            self.values[key] = value
        self.reads = {k: v for k, v in self.values.items() if isinstance(v, ReadValue)}
        self.writes = {k: v for k, v in self.values.items() if isinstance(v, WriteValue)}
        self.listeners: Listeners[Snapshot] = Listeners(path)
        self._watching = threading.Lock()  # held while a listener is added
        self._by_link: dict[Link, dict[str, ReadValue[Any]]] = {}
        for key, value in self.reads.items():
            self._by_link.setdefault(value.hardware.link, {})[key] = value
        self._labels: dict[Link, str] = {}  # two links may have the same URL
        for link in self._by_link:
            number = sum(other.url == link.url for other in self._labels) + 1
            self._labels[link] = link.url if number == 1 else f"{link.url}#{number}"
        self._readings: dict[bool, dict[Link, Reading]] = {}
        links = list(self._by_link)
        self._sole = SoleLink(links[0], self._labels[links[0]], self.reads) if len(links) == 1 else None
        self._burst = Burst.of(list(self.writes.values()))
        self._sets = Sets(self.reads, self._labels)

    def __iter__(self) -> Iterator[Value[Any]]:
        return iter(self.values.values())

    def __len__(self) -> int:
        return len(self.values)

    def __getitem__(self, key: str) -> Value[Any]:
        try:
            return self.values[key]
        except (KeyError, TypeError):
            raise UnknownName(f"{self.path}: no {shown(key)}; there are {', '.join(self.values)}") from None

    def __setitem__(self, key: str, value: object) -> None:
        """Refuse the assignment, because a write was probably meant."""
        refuse(f"{self.path}[{key!r}]", self.values.get(key), value)

    def __setattr__(self, name: str, value: object) -> None:
        """Refuse new attributes, because nothing would write them."""
        if "_sets" in self.__dict__:
            raise AssignmentError(
                f"{self.path}.{name} is not set to {shown(value)}; write values of the group: "
                f"{self.path}.write(...)"
            )
        object.__setattr__(self, name, value)

    def _repr_html_(self) -> str:
        """Return what a notebook shows."""
        return values_html(self.path, self.values.values())

    def __repr__(self) -> str:
        return f"<group {self.path} of {', '.join(self.values)}>"

    # Reading

    def snapshot(self, *, consistent: bool = True, timeout_s: float | None = None) -> Snapshot:
        """Read all READs with one atomic read for each link, all links at the same time.

        Raises DeviceMismatch if one atomic read cannot hold them, unless `consistent` is False.
        """
        readings = self._reading(consistent)
        try:
            if (sole := self._sole) is not None:
                return sole.taken(*readings[sole.link].fetch(sole.link, timeout_s))
            jobs = [partial(reading.fetch, link, timeout_s) for link, reading in readings.items()]
            fetched = at_once(self._by_link, jobs)
        except LinkError as error:
            raise self._named(error)  # noqa: B904  the same error, now with its name
        return self.taken(dict(zip(self._by_link, fetched, strict=True)))

    async def snapshot_async(self, *, consistent: bool = True, timeout_s: float | None = None) -> Snapshot:
        """Read all READs with one atomic read for each link, all links at the same time."""
        readings = self._reading(consistent)

        async def fetch(link: Link) -> tuple[float, list[int]]:
            started = link.now_s()
            words: list[int] = []
            parts, checked, repeat = readings[link]
            for addresses, atomic in parts:
                read = await link.read_many_async(
                    addresses, atomic=atomic, checked=checked, repeat=repeat, timeout_s=timeout_s
                )
                words += read.tolist()
            return (started + link.now_s()) / 2, words

        try:
            fetched = await _all(fetch(link) for link in self._by_link)
        except LinkError as error:
            raise self._named(error)  # noqa: B904
        return self.taken(dict(zip(self._by_link, fetched, strict=True)))

    def _reading(self, consistent: bool) -> dict[Link, Reading]:
        """Return how the READs of each link are read, after a check that this is possible."""
        if consistent not in self._readings:
            self._check_snapshot(consistent)
            self._readings[consistent] = {
                link: Reading.of(list(values.values()), consistent) for link, values in self._by_link.items()
            }
        return self._readings[consistent]

    def _check_snapshot(self, consistent: bool) -> None:
        if not self.reads:
            raise ValueRangeError(f"{self.path}: there is no READ to take a snapshot of")
        for link, values in self._by_link.items():
            limit = max(1, link.configuration.read_many)
            words = sum(value.codec.words for value in values.values())
            if words > limit and consistent:
                few = "" if words == len(values) else f" of {words} words"
                raise DeviceMismatch(
                    f"{self.path}: {len(values)} values{few} do not fit one atomic read of {limit} words "
                    f"at {link.url}; take smaller groups, or snapshot(consistent=False)"
                )

    def taken(self, fetched: Mapping[Link, tuple[float, list[int]]]) -> Snapshot:
        """Make a snapshot from the time of the read on each link, and the words of its READs in order."""
        numbers: dict[str, Any] = dict.fromkeys(self.reads)  # in their order
        times_s: dict[str, float] = {}
        sampled_s: dict[str, float] = {}
        for link, values in self._by_link.items():
            time_s, words = fetched[link]
            times_s[self._labels[link]] = time_s
            taken = join(list(values.values()), words)
            for (key, value), raw in zip(values.items(), taken, strict=True):
                numbers[key] = value.take(raw)
            sampled_s.update(dict.fromkeys(values, time_s))
        return Snapshot(numbers, times_s, sampled_s)

    # Writing

    def write(
        self,
        values: Mapping[str, Any] | Sequence[Any] | None = None,
        /,
        *,
        timeout_s: float | None = None,
        **named: Any,
    ) -> None:
        """Write WRITEs together.

        Give a sequence with a value for each of them in order, or a mapping or keywords for some.

        A keyword is a key with "_" in place of characters that a name cannot have ("j[2].pos" is j_2_pos). It
        may also be the last step of a key, if that is unique. All values are checked before the first is
        sent. Each hardware proxy gets one burst, on TosNet with one commit. All links are written at the same
        time.
        """
        in_order = not named and isinstance(values, (list, tuple)) and len(values) == len(self.writes)
        if self._burst is not None and in_order:
            try:
                return self._burst.write(values, timeout_s)  # type: ignore[arg-type]  # it is in order
            except LinkError as error:
                raise self._named(error)  # noqa: B904
        writes = self._words(values, named)
        batched = [hardware for hardware in writes if hardware.collects_here]
        by_link: dict[Link, list[HardwareProxy]] = {}
        for hardware in writes:
            if hardware not in batched:
                by_link.setdefault(hardware.link, []).append(hardware)

        def send(proxies: list[HardwareProxy]) -> None:
            for hardware in proxies:
                items = writes[hardware]
                addresses, words, checked = burst_of(items)
                hardware.write_many(addresses, words, checked=checked, timeout_s=timeout_s)
                for value, raw in items:
                    value.wrote(raw)

        try:
            send(batched)  # sent here, because a batch belongs to its thread
            at_once(by_link, [partial(send, proxies) for proxies in by_link.values()])
        except LinkError as error:
            raise self._named(error)  # noqa: B904

    async def write_async(
        self,
        values: Mapping[str, Any] | Sequence[Any] | None = None,
        /,
        *,
        timeout_s: float | None = None,
        **named: Any,
    ) -> None:
        """Write WRITEs together, as `write` does."""
        writes = self._words(values, named)

        async def send(hardware: HardwareProxy) -> None:
            items = writes[hardware]
            addresses, words, checked = burst_of(items)
            await hardware.write_many_async(addresses, words, checked=checked, timeout_s=timeout_s)
            for value, raw in items:
                value.wrote(raw)

        try:
            await _all(send(hardware) for hardware in writes)
        except LinkError as error:
            raise self._named(error)  # noqa: B904

    def cycle(self) -> Cycle:
        """Return a Cycle: each call writes all WRITEs and reads all READs, as a control loop does.

        >>> with group.cycle() as cycle:                                 # doctest: +SKIP
        ...     state = cycle(j1_pos_sp=100, j2_pos_sp=-200)
        """
        return Cycle(self)

    def chosen(
        self, values: Mapping[str, Any] | Sequence[Any] | None, named: Mapping[str, Any]
    ) -> dict[WriteValue[Any], Any]:
        """Return the WRITEs that a call of `write` names, with their values."""
        chosen: dict[WriteValue[Any], Any] = {}
        if isinstance(values, Mapping):
            for key, number in values.items():
                if key not in self.writes:
                    raise ValueRangeError(
                        f"{self.path}: no WRITE {shown(key)}; there are {', '.join(self.writes)}"
                    )
                chosen[self.writes[key]] = number
        elif values is None:
            if not named:
                raise ValueRangeError(f"{self.path}: nothing to write; there are {', '.join(self.writes)}")
        elif isinstance(values, (str, bytes)) or not _has_length(values):
            raise ValueRangeError(
                f"{self.path}: {shown(values)} is not a sequence or mapping of values for its "
                f"{len(self.writes)} WRITEs ({', '.join(self.writes)}); nothing was sent"
            )
        else:
            if len(values) != len(self.writes):
                raise ValueRangeError(
                    f"{self.path}: {len(values)} values for {len(self.writes)} WRITEs "
                    f"({', '.join(self.writes)})"
                )
            chosen.update(zip(self.writes.values(), values, strict=True))
        for name, number in named.items():
            chosen[self._by_keyword(name)] = number
        return chosen

    def _words(self, values: Mapping[str, Any] | Sequence[Any] | None, named: Mapping[str, Any]) -> Writes:
        writes: Writes = {}
        for value, number in self.chosen(values, named).items():
            writes.setdefault(value.hardware, []).append((value, value.encode(number)))
        return writes

    def _by_keyword(self, name: str) -> WriteValue[Any]:
        full = [value for key, value in self.writes.items() if _keyword(key) == name]
        short = [value for key, value in self.writes.items() if key.rpartition(".")[2] == name]
        for matches in (full, short):
            if len(matches) == 1:
                return matches[0]
        known = ", ".join(map(_keyword, self.writes))
        trouble = "is more than one WRITE" if full or short else "is not a WRITE"
        raise ValueRangeError(f"{self.path}: {name} {trouble}; there are {known}")

    # Publishing

    def on_publish(
        self, callback: Callable[[float, Snapshot], object], *, rate_hz: float | None = None
    ) -> Callable[[], None]:
        """Call `callback(time_s, snapshot)` for each set of fresh samples. Return a function that ends this.

        There is a set for each tick of each rate, and for each event. Values of one rate are of one tick,
        whatever gateware groups carry them. The other values are the newest that have come.
        `snapshot.sampled_s` says when each was sampled.

        Values that are published on an event, or at another rate, are read once at the beginning. A value
        that a read changes is in no set before it has been published. READs without PUBLISH need `rate_hz`.
        The PC then polls them.
        """
        return self._with_watch(self.listeners.on_publish(callback), rate_hz)

    def on_change(
        self, callback: Callable[[Snapshot], object], *, rate_hz: float | None = None
    ) -> Callable[[], None]:
        """Call `callback(snapshot)` for each set in which a value has changed. See `on_publish`."""
        return self._with_watch(self.listeners.on_change(callback), rate_hz)

    def publishes(self, *, rate_hz: float | None = None) -> AsyncIterator[tuple[float, Snapshot]]:
        """Iterate over sets: `async for time_s, snapshot in group.publishes():`. See `on_publish`."""
        return self.listeners.stream(
            lambda: self._watch(rate_hz),
            lambda: all(value.is_published() for value in self.reads.values()),
            lambda: self._newest(rate_hz),
        )

    def _newest(self, rate_hz: float | None) -> tuple[float, Snapshot] | None:
        """Return the current set if a value is published on change and has been published already."""
        rare = [v for v in self.reads.values() if v.publish is not None and v.publish.trigger == "change"]
        if not rare or not all(value.publisher.newest(value) for value in rare):
            return None
        self._watch(rate_hz)
        snapshot = self._sets.current()
        return None if snapshot is None else (snapshot.time_s, snapshot)

    def _with_watch(self, take_back: Callable[[], None], rate_hz: float | None) -> Callable[[], None]:
        """Start the publishes for a listener. The listener is registered before the first publish."""
        try:
            self._watch(rate_hz)
        except BaseException:
            take_back()
            raise
        return take_back

    def _watch(self, rate_hz: float | None) -> None:
        if not self.reads:
            raise ValueRangeError(f"{self.path}: there is no READ to be published")
        reads = self.reads.values()
        for value in reads:
            value.publisher.demand(value, None if value.publish else rate_hz)
        with self._watching:
            self._sets.expect({value: value.publisher.planned(value) for value in reads})
            for value in reads:
                if self not in value.groups:
                    value.groups += (self,)
            self._seed()
        for value in reads:
            value.publisher.require(value)

    def _seed(self) -> None:
        """For the first set, read once the values that come at another time.

        Leave out values that a read changes.
        """
        by_link: dict[Link, list[PublishedValue]] = {}
        for value in self._sets.unknown:
            if value.pollable and value.hardware.repeatable_reads:
                by_link.setdefault(value.hardware.link, []).append(value)
        for link, values in by_link.items():
            time_s = link.now_s()
            try:
                words = [
                    word
                    for addresses, atomic in portions(values, False)
                    for word in link.read_many(addresses, atomic=atomic, checked=any_checked(values)).tolist()
                ]
            except LinkError as error:
                raise self._named(error)  # noqa: B904
            for value, raw in zip(values, join(values, words), strict=True):
                with suppress(UnexpectedValue):  # then no set has it before it comes
                    self._sets.seed(time_s, value, value.codec.decode(raw))
        self._sets.begin()

    def take(self, time_s: float, values: Sequence[ReadValue[Any]], numbers: Sequence[Any]) -> None:
        """Take a publish that carries some of our values. If it completes a set, call the listeners."""
        snapshot = self._sets.take(time_s, values, numbers)
        if snapshot is not None:
            self.listeners.tell(time_s, snapshot)

    def _named(self, error: LinkError) -> LinkError:
        return error.with_item(self.path)


def _has_length(values: object) -> bool:
    try:
        len(values)  # type: ignore[arg-type]
    except TypeError:  # raised also for numpy's scalars, which have the method
        return False
    return True


def _keyword(key: str) -> str:
    return re.sub(r"\W+", "_", key)


async def _all(jobs: Iterable[Coroutine[Any, Any, R]]) -> list[R]:
    """Await jobs at the same time. All jobs end before the first error is raised."""
    ended = await asyncio.gather(*jobs, return_exceptions=True)
    for result in ended:
        if isinstance(result, BaseException):
            raise result
    return cast("list[R]", ended)
