# SPDX-License-Identifier: BSD-3-Clause
"""Values over time for a plot: numbers, and the names of enumerations as steps of a scale."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

from unitylink.spec.types import ValueType

Part = tuple[str, str, tuple[str, ...]]  # path, unit, the names of members


def parts_of(path: str, kind: ValueType, unit: str) -> Iterator[Part]:
    """Yield the parts of a value that are drawn: itself, or the fields of a packed one."""
    if kind.kind == "bits":
        for field in kind.fields:
            yield from parts_of(f"{path}.{field.name}", field.type, field.unit)
    else:
        yield path, unit, () if kind.enum is None else tuple(item.name for item in kind.enum.values)


class Series:
    """Times and numbers of one path.

    `unit` is their unit. `members` are the names of the numbers 0, 1, 2 ....
    """

    def __init__(self, unit: str = "", members: tuple[str, ...] = ()) -> None:
        self.unit = unit
        self.members = list(members)
        self.times_s: list[float] = []
        self.numbers: list[float] = []

    def take(self, time_s: float, value: Any) -> None:
        """Add a number, a truth value or the name of a member.

        Anything else is left out, because a plot cannot show it.
        """
        if isinstance(value, str):
            if value not in self.members:
                self.members.append(value)
            value = self.members.index(value)
        if isinstance(value, (int, float)):
            self.times_s.append(time_s)
            self.numbers.append(float(value))

    def forget(self, before_s: float) -> None:
        """Drop all values from before `before_s`."""
        old = sum(1 for time_s in self.times_s if time_s < before_s)
        del self.times_s[:old], self.numbers[:old]


class AllSeries(dict[str, Series]):
    """Series by path. Each field of a packed value has one, such as `arm.status.ready`."""

    def __init__(self, wanted: Callable[[str], bool] = lambda path: True) -> None:
        super().__init__()
        self._wanted = wanted

    def declare(self, parts: Iterable[Part]) -> None:
        """Announce a path, so that its unit and the order of an enumeration's members are known."""
        self.update({path: Series(unit, members) for path, unit, members in parts})

    def take(self, time_s: float, values: Mapping[str, Any]) -> None:
        """Add the values of one moment, in the form that a recording has."""
        for path, value in values.items():
            if isinstance(value, Mapping):
                self.take(time_s, {f"{path}.{name}": part for name, part in value.items()})
            elif self._wanted(path):
                self.setdefault(path, Series()).take(time_s, value)

    def begin_at_zero(self) -> None:
        """Count times from the first value on."""
        begin_s = min((one.times_s[0] for one in self.values() if one.times_s), default=0.0)
        for one in self.values():
            one.times_s = [time_s - begin_s for time_s in one.times_s]

    @property
    def count(self) -> int:
        """How many values there are."""
        return sum(len(one.times_s) for one in self.values())
