# SPDX-License-Identifier: BSD-3-Clause
"""Values that were sampled together."""

from __future__ import annotations

from collections.abc import ItemsView, Iterator, KeysView, Mapping, ValuesView
from typing import Any

from unitylink.errors import UnknownName, shown


class Snapshot(Mapping[str, Any]):
    """A read-only mapping from path to value in engineering units, with the time of the sample.

    `time_s` is the monotonic host time of the newest part. `times_s` has one time for each link (by URL),
    because a group over several links is consistent only within each link. `sampled_s` has the time of each
    value, by path.

    >>> s = Snapshot({"j1.cpos": -3, "j2.cpos": 4}, {"sim:": 12.5}, {"j1.cpos": 12.5, "j2.cpos": 12.0})
    >>> s["j1.cpos"], s.time_s, s.time_s - s.sampled_s["j2.cpos"]
    (-3, 12.5, 0.5)
    """

    __slots__ = ("_values", "sampled_s", "times_s")
    _values: dict[str, Any]
    times_s: dict[str, float]
    sampled_s: dict[str, float]

    def __init__(
        self, values: Mapping[str, Any], times_s: Mapping[str, float], sampled_s: Mapping[str, float]
    ) -> None:
        self._values = dict(values)
        self.times_s = dict(times_s)
        self.sampled_s = dict(sampled_s)

    @classmethod
    def of_one(cls, values: dict[str, Any], label: str, time_s: float) -> Snapshot:
        """Return what was read on one link at one time. The dictionary becomes the snapshot's own."""
        made = cls.__new__(cls)
        made._values = values
        made.times_s = {label: time_s}
        made.sampled_s = dict.fromkeys(values, time_s)
        return made

    @property
    def time_s(self) -> float:
        return max(self.times_s.values())

    def __getitem__(self, path: str) -> Any:
        try:
            return self._values[path]
        except (KeyError, TypeError):
            known = ", ".join(self._values)
            raise UnknownName(f"no {shown(path)} in the set; there are {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    # those of the dictionary are several times as quick as those of Mapping

    def keys(self) -> KeysView[str]:
        return self._values.keys()

    def values(self) -> ValuesView[Any]:
        return self._values.values()

    def items(self) -> ItemsView[str, Any]:
        return self._values.items()

    def __repr__(self) -> str:
        return f"Snapshot({self._values}, {self.times_s})"
