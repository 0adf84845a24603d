# SPDX-License-Identifier: BSD-3-Clause
"""The rows of the table as text: parts of the robot, and their items with value, unit, age and remark."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from ..live_table import overdue
from ..value_text import shown

if TYPE_CHECKING:
    from unitylink.dashboard.feed import Track
    from unitylink.spec.model import Element, Instance


@dataclass(frozen=True)
class Part:
    """A row that is a part of the robot. `depth` is how deep in the tree it is."""

    path: str
    title: str
    depth: int


@dataclass(frozen=True)
class ItemRow:
    """A row that is an item. `facts` is its description for the page of the dashboard."""

    element: Element
    depth: int
    facts: Mapping[str, Any] = field(repr=False)

    @property
    def path(self) -> str:
        return self.element.path


@dataclass(frozen=True)
class Cells:
    """The texts of an item's row. `late` tells whether its value is overdue."""

    value: str
    unit: str
    age: str
    remark: str
    late: bool = False


def rows(root: Instance, facts: Mapping[str, Mapping[str, Any]], depth: int = 0) -> Iterator[Part | ItemRow]:
    """Yield the rows of a robot, in the order of its spec. `facts` has a description for each path."""
    for element in root.elements:
        yield ItemRow(element, depth, facts[element.path])
    for part in root.instances:
        yield Part(part.path, part.display or part.name, depth)
        yield from rows(part, facts, depth + 1)


def name_of(row: Part | ItemRow, closed: bool = False) -> str:
    """Return the text in the first column."""
    if isinstance(row, Part):
        name = row.path.rpartition(".")[2]
        title = f" {row.title}" if row.title != name else ""
        return f"{'  ' * row.depth}{'+' if closed else '-'} {name}{title}"
    return f"{'  ' * row.depth}{row.element.name}"


def cells(row: ItemRow, track: Track, now_s: float, chart: str = "") -> Cells:
    """Return the texts of an item now. `chart` is its mark if it is drawn."""
    remarks = [f"chart {chart}"] if chart else []
    if row.facts["verb"]:
        remarks.append(row.facts["verb"])
    newest = track.history.newest()
    if newest is None or track.raw is None:
        return Cells("-", row.element.unit, "", ", ".join(remarks))
    time_s, number = newest
    age_s = max(0.0, now_s - time_s)
    late = overdue(age_s, track.rate_hz)
    value = track.value.codec.decode(track.raw)
    remarks = ["late"] * late + limits(row, number) + remarks
    return Cells(
        shown(value, track.value.quantity), row.element.unit, age_text(age_s), ", ".join(remarks), late
    )


def limits(row: ItemRow, number: float) -> list[str]:
    """Return a remark if a value is beyond MIN or MAX of the spec."""
    least, greatest = row.element.minimum, row.element.maximum
    if row.facts["kind"] != "number" or not math.isfinite(number):
        return []
    if least is not None and number < float(least):
        return [f"BELOW {float(least):g}"]
    if greatest is not None and number > float(greatest):
        return [f"ABOVE {float(greatest):g}"]
    return []


def age_text(age_s: float) -> str:
    """Return an age for a narrow column.

    >>> age_text(0.04), age_text(7.2), age_text(75), age_text(9000)
    ('0.0 s', '7.2 s', '75 s', '150 min')
    """
    if age_s < 10:
        return f"{age_s:.1f} s"
    return f"{age_s:.0f} s" if age_s < 600 else f"{age_s / 60:.0f} min"
