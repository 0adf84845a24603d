# SPDX-License-Identifier: BSD-3-Clause
"""One running publish: values that are sampled together, and what happens when they arrive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, Protocol

from unitylink import protocol
from unitylink.errors import UnexpectedValue
from unitylink.spec.model import Publish

from .listeners import logger
from .published import HasCodec, PublishedGroup, PublishedValue

if TYPE_CHECKING:
    from unitylink.layer2_message import Link
    from unitylink.layer2_message.native_link import Times, Words


HARDWARE, SOFTWARE = 1, 2  # the modes of PUBLISH(mode, divisor)


def base_hz(link: Link) -> int:
    """Return the base publish frequency. If the gateware has none, the default is used for polling."""
    return link.configuration.base_hz or protocol.BASE_HZ_DEFAULT


@dataclass(frozen=True)
class PublishPlan:
    """Values of one link that are published together: by one gateware group (mode 1) or one poll (mode 2).

    `number` is the gateware's group if it must be a certain one. This is the group whose event line triggers
    the publish.
    """

    link: Link
    publish: Publish
    values: tuple[PublishedValue, ...]
    number: int | None = None

    @property
    def mode(self) -> int:
        return self.publish.mode

    @property
    def divisor(self) -> int:
        return self.publish.divisor

    @property
    def addresses(self) -> list[int]:
        return [address for value in self.values for address in value.addresses]

    @property
    def checked(self) -> bool | None:
        return True if any(value.checked for value in self.values) else None

    @property
    def repeatable(self) -> bool:
        """Whether the words may be read once more without harm."""
        return all(value.pollable and value.hardware.repeatable_reads for value in self.values)

    @property
    def rate_hz(self) -> float:
        """The rate. It is 0 if an event triggers the publish, and not the clock."""
        return base_hz(self.link) / self.divisor if self.divisor else 0.0

    def polled(self) -> PublishPlan:
        """Return the same plan, polled by the PC."""
        return replace(self, publish=replace(self.publish, mode=SOFTWARE), number=None)


@dataclass(frozen=True)
class PublishReport:
    """What one publish has done so far. `rate_hz` is 0 if an event triggers it.

    `lost` publishes were overwritten before they were taken, were not polled, or held an invalid number for
    their type.
    """

    url: str
    hardware: bool
    rate_hz: float
    paths: tuple[str, ...]
    received: int
    lost: int


# time_s, the values, their numbers in engineering units, their raw numbers
Taker = Callable[[float, Sequence[PublishedValue], Sequence[Any], Sequence[int]], None]
# many publishes at once: (n,) times in s, the k values, (n, k) raw numbers
ArraysTaker = Callable[["Times", Sequence[PublishedValue], "Words"], None]
# without the second one, the taker wants each publish by itself
Takers = Sequence[tuple[Taker, ArraysTaker | None]]


class Source(Protocol):
    """The source of the words: a gateware subscription or a polling thread."""

    @property
    def lost(self) -> int: ...
    def close(self) -> None: ...


def join(values: Sequence[HasCodec], words: Sequence[int]) -> list[int]:
    """Return the raw numbers of values from their words, one value after the other."""
    if len(words) == len(values):
        return list(words)
    raws, start = [], 0
    for value in values:
        raws.append(value.codec.join(words[start : start + value.codec.words]))
        start += value.codec.words
    return raws


class Publication:
    """Turn the words of one publish into values, then tell the values' and groups' listeners.

    All values are updated before the first callback, so every callback of one publish sees one consistent
    snapshot.
    """

    def __init__(self, plan: PublishPlan, takers: Takers) -> None:
        self.plan = plan
        self.received = 0
        self.source: Source | None = None
        self.takers = takers
        codecs = [value.codec for value in plan.values]
        self._simple = all(codec.integer_sign is not None and codec.words == 1 for codec in codecs)
        self._signs = [(codec.mask, codec.sign) for codec in codecs]
        self._unexpected = 0
        self._rare = plan.publish.trigger == "change"
        self.newest: tuple[float, Sequence[Any]] | None = None
        """Of what is published on change: the last publish, for those who come later."""

    def deliver(self, time_s: float, words: Sequence[int]) -> None:
        """Take one publish: raw words in the order of the plan's values."""
        values = self.plan.values
        raws: Sequence[int]
        numbers: list[Any]
        if self._simple:
            raws, numbers = words, []
            for value, word, (mask, sign) in zip(values, words, self._signs, strict=True):
                value.raw = word
                value.latest = number = ((word & mask) ^ sign) - sign
                numbers.append(number)
        else:
            raws = join(values, words)
            try:
                numbers = [value.codec.decode(raw) for value, raw in zip(values, raws, strict=True)]
            except UnexpectedValue as error:
                self._unexpected += 1
                if self._unexpected == 1:
                    logger.error("a publish was dropped, and so will be all like it: %s", error)
                return
            for value, raw, number in zip(values, raws, numbers, strict=True):
                value.raw, value.latest = raw, number
        self.received += 1
        if self._rare:
            self.newest = time_s, numbers
        groups: dict[PublishedGroup, None] = {}  # used as a set that keeps its order
        for value, number in zip(values, numbers, strict=True):
            listeners = value.listeners
            if listeners.heard:
                listeners.tell(time_s, number)
            else:
                listeners.previous = number
            if value.groups:
                groups.update(dict.fromkeys(value.groups))
        for group in groups:
            group.take(time_s, values, numbers)
        for take, _ in self.takers:
            take(time_s, values, numbers, raws)

    def deliver_arrays(self, times: Times, words: Words) -> bool:
        """Take many publishes at once.

        Return False, and do nothing, if a listener wants each publish by itself.

        If a fast stream is only recorded, or only its latest value counts, arrays are much cheaper.
        """
        values, takers = self.plan.values, self.takers
        if not self._simple or self._rare or any(arrays is None for _, arrays in takers):
            return False
        if any(value.groups or value.listeners.heard for value in values):
            return False
        newest, time_s = words[-1].tolist(), float(times[-1])
        for value, word, (mask, sign) in zip(values, newest, self._signs, strict=True):
            value.raw, value.latest = word, ((word & mask) ^ sign) - sign
            value.listeners.tell(time_s, value.latest)
        self.received += len(times)
        for _, arrays in takers:
            if arrays is not None:
                arrays(times, values, words)
        return True

    def close(self) -> None:
        if self.source is not None:
            self.source.close()

    def report(self) -> PublishReport:
        plan = self.plan
        return PublishReport(
            url=plan.link.url,
            hardware=plan.mode == HARDWARE,
            rate_hz=plan.rate_hz,
            paths=tuple(value.path for value in plan.values),
            received=self.received,
            lost=(self.source.lost if self.source is not None else 0) + self._unexpected,
        )
