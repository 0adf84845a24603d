# SPDX-License-Identifier: BSD-3-Clause
"""One running publish: the values that are sampled together, and what is done when they arrive."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol

from unitylink import protocol

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

    from .group import ValueGroup
    from .value import ReadValue

HARDWARE, SOFTWARE = 1, 2  # the modes of PUBLISH(mode, divisor)


def base_hz(link: Link) -> int:
    """Return the base publish frequency; gateware that has none is polled by the usual one."""
    return link.configuration.base_hz or protocol.BASE_HZ_DEFAULT


@dataclass(frozen=True)
class PublishPlan:
    """Values of one link, one rate and one mode that fit one gateware group (mode 1) or one poll (mode 2)."""

    link: Link
    mode: int
    divisor: int
    values: tuple[ReadValue, ...]

    @property
    def addresses(self) -> list[int]:
        return [value.address for value in self.values]

    @property
    def checked(self) -> bool | None:
        return True if any(value.checked for value in self.values) else None

    @property
    def rate_hz(self) -> float:
        return base_hz(self.link) / self.divisor


@dataclass(frozen=True)
class PublishReport:
    """What one publish has done so far; `lost` were overwritten before they were taken, or not polled."""

    url: str
    hardware: bool
    rate_hz: float
    paths: tuple[str, ...]
    received: int
    lost: int


Taker = Callable[[float, Sequence["ReadValue"], Sequence[int]], None]


class Source(Protocol):
    """What brings the words: a gateware subscription or a polling thread."""

    @property
    def lost(self) -> int: ...
    def close(self) -> None: ...


class Publication:
    """Turn the words of one publish into values, then tell the values' and groups' listeners.

    All values are updated before the first callback, so every callback of one publish sees one consistent
    snapshot.
    """

    def __init__(self, plan: PublishPlan, takers: Callable[[], Sequence[Taker]]) -> None:
        self.plan = plan
        self.received = 0
        self.source: Source | None = None
        self._takers = takers
        self._signs = [value.sign for value in plan.values]

    def deliver(self, time_s: float, words: Sequence[int]) -> None:
        """Take one publish: raw words in the order of the plan's values."""
        values = self.plan.values
        numbers = [(word ^ sign) - sign for word, sign in zip(words, self._signs, strict=True)]
        for value, number in zip(values, numbers, strict=True):
            value.latest = number
        self.received += 1
        groups: dict[ValueGroup, None] = {}  # a set that keeps its order
        for value, number in zip(values, numbers, strict=True):
            value.listeners.tell(time_s, number)
            groups.update(dict.fromkeys(value.groups))
        for group in groups:
            group.take(time_s, values, numbers)
        for take in self._takers():
            take(time_s, values, numbers)

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
            lost=self.source.lost if self.source is not None else 0,
        )
