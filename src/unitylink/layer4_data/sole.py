# SPDX-License-Identifier: BSD-3-Clause
"""Groups on one link: what can be known before a snapshot or a write. Loops call these most."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from .portions import any_checked
from .publication import join
from .snapshot import Snapshot

if TYPE_CHECKING:
    from unitylink.layer2_message import Link

    from .read_value import ReadValue
    from .write_value import WriteValue


class SoleLink:
    """The READs of a group where all are on one link: how their words become a snapshot."""

    def __init__(self, link: Link, label: str, values: Mapping[str, ReadValue[Any]]) -> None:
        self.link = link
        self._label = label
        self._values = [
            (key, value, value.codec.mask, value.codec.integer_sign) for key, value in values.items()
        ]

    def taken(self, time_s: float, words: list[int]) -> Snapshot:
        """Make a snapshot from the time of the read, and the words of the READs in order."""
        raws = words
        if len(words) != len(self._values):
            raws = join([value for _, value, _, _ in self._values], words)
        numbers: dict[str, Any] = {}
        for (key, value, mask, sign), raw in zip(self._values, raws, strict=True):
            if sign is None:
                numbers[key] = value.take(raw)
            else:  # as take() does, without a call
                value.raw = raw
                value.latest = numbers[key] = ((raw & mask) ^ sign) - sign
        return Snapshot.of_one(numbers, self._label, time_s)


class Burst:
    """The WRITEs of a group where all are of one hardware proxy: what can be known before a write."""

    def __init__(self, values: Sequence[WriteValue[Any]]) -> None:
        self.hardware = values[0].hardware
        self.addresses = [address for value in values for address in value.relative_addresses]
        self.checked = any_checked(values)
        self._whole = len(self.addresses) == len(values)
        self._values = [(v, v.codec.encoder, v.codec.mask, v.codec.integer_sign) for v in values]

    @classmethod
    def of(cls, values: Sequence[WriteValue[Any]]) -> Burst | None:
        """Return the burst of some values. None: none, one twice, or of several proxies."""
        sole = len({value.hardware for value in values}) == 1 and len(set(values)) == len(values)
        return cls(values) if sole else None

    def write(self, numbers: Sequence[Any], timeout_s: float | None) -> None:
        """Write a number for each value. All are checked before the first is sent."""
        raws = [encode(number) for (_, encode, _, _), number in zip(self._values, numbers, strict=True)]
        words = raws
        if not self._whole:
            words = [
                word for (v, *_), raw in zip(self._values, raws, strict=True) for word in v.codec.split(raw)
            ]
        self.hardware.write_burst(self.addresses, words, checked=self.checked, timeout_s=timeout_s)
        for (value, _, mask, sign), raw in zip(self._values, raws, strict=True):
            if sign is None or value.recorders:
                value.wrote(raw)
            else:
                value.raw, value.latest = raw, ((raw & mask) ^ sign) - sign
