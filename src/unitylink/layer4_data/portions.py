# SPDX-License-Identifier: BSD-3-Clause
"""Which words of some values are read at once, and written at once."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

from .published import PublishedValue

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

    from .write_value import WriteValue


class Reading(NamedTuple):
    """How some values of a link are read: the portions (addresses, atomic), and what is said with each."""

    portions: list[tuple[list[int], bool]]
    checked: bool | None
    repeat: bool

    @classmethod
    def of(cls, values: Sequence[PublishedValue], consistent: bool) -> Reading:
        repeat = all(value.pollable and value.hardware.repeatable_reads for value in values)
        return cls(portions(values, consistent), any_checked(values), repeat)

    def fetch(self, link: Link, timeout_s: float | None) -> tuple[float, list[int]]:
        """Return the time in the middle of the reads, and the words."""
        checked, repeat = self.checked, self.repeat
        if len(self.portions) == 1:
            addresses, atomic = self.portions[0]
            return link.sample(addresses, atomic=atomic, checked=checked, repeat=repeat, timeout_s=timeout_s)
        begun_s, words = link.now_s(), []
        for addresses, atomic in self.portions:
            read = link.read_many(
                addresses, atomic=atomic, checked=checked, repeat=repeat, timeout_s=timeout_s
            )
            words += read.tolist()
        return (begun_s + link.now_s()) / 2, words


def any_checked(values: Iterable[PublishedValue | WriteValue[Any]]) -> bool | None:
    return True if any(value.checked for value in values) else None


def burst_of(items: Sequence[tuple[WriteValue[Any], int]]) -> tuple[list[int], list[int], bool | None]:
    """Return the addresses and words of values with their raw numbers, and whether they are checked."""
    addresses: list[int] = []
    words: list[int] = []
    checked = None
    for value, raw in items:
        addresses += value.relative_addresses
        words += (raw,) if value.codec.words == 1 else value.codec.split(raw)
        checked = checked or value.checked
    return addresses, words, checked


def portions(values: Sequence[PublishedValue], consistent: bool) -> list[tuple[list[int], bool]]:
    """Return the portions that are read at once: (addresses, atomic).

    A value of several words is never divided.
    """
    whole = [address for value in values for address in value.addresses]
    if consistent or len(whole) == len(values):
        return [(whole, consistent and len(whole) > 1)]
    limit = max(1, values[0].hardware.link.configuration.read_many)
    parts: list[tuple[list[int], bool]] = [([], True)]
    for value in values:
        if parts[-1][0] and len(parts[-1][0]) + value.codec.words > limit:
            parts.append(([], True))
        parts[-1][0].extend(value.addresses)
    return parts
