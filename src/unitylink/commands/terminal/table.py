# SPDX-License-Identifier: BSD-3-Clause
"""The table of the screen: all items of a robot below each other, with a cursor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

from rich.text import Text

from .rows import Cells, ItemRow, Part, cells, name_of

if TYPE_CHECKING:
    from unitylink.dashboard.feed import Feed

VALUE = 14  # characters


class Table:
    """The rows of a robot, and which of them can be seen."""

    def __init__(self, rows: Sequence[Part | ItemRow]) -> None:
        self.rows = list(rows)
        self.closed: set[str] = set()  # paths of folded parts
        self.cursor = 0
        self._top = 0

    def open_rows(self) -> list[Part | ItemRow]:
        """Return the rows that are not in a folded part."""
        found: list[Part | ItemRow] = []
        hidden = math.inf
        for row in self.rows:
            if row.depth > hidden:
                continue
            hidden = row.depth if isinstance(row, Part) and row.path in self.closed else math.inf
            found.append(row)
        return found

    @property
    def chosen(self) -> Part | ItemRow:
        """The row of the cursor."""
        return self.open_rows()[self.cursor]

    def move(self, rows: int) -> None:
        self.cursor = min(max(0, self.cursor + rows), len(self.open_rows()) - 1)

    def fold(self, part: Part) -> None:
        """Fold a part, or unfold it."""
        self.closed ^= {part.path}

    def text(self, feed: Feed, charts: Sequence[str], now_s: float, width: int, height: int) -> Text:
        """Return the lines around the cursor. The first one has the headings."""
        shown = self.open_rows()
        height = max(1, height - 1)
        self._top = min(max(self._top, self.cursor - height + 1), self.cursor, max(0, len(shown) - height))
        tracks = {track.value.path: track for track in feed.tracks}
        units = max([4, *(len(row.element.unit) for row in self.rows if isinstance(row, ItemRow))])
        names = 2 + max(len(name_of(row)) for row in self.rows)
        columns = _Columns(max(12, min(names, width - units - 40)), units, width)
        text = Text(no_wrap=True)
        text.append(columns.line("  name", Cells("value", "unit", "age", "remark")), style="bold")
        for number, row in list(enumerate(shown))[self._top : self._top + height]:
            here = number == self.cursor
            name = f"{'> ' if here else '  '}{name_of(row, row.path in self.closed)}"
            if isinstance(row, Part):
                line, style = name[:width].ljust(width), "bold"
            else:
                chart = str(charts.index(row.path) + 1) if row.path in charts else ""
                one = cells(row, tracks[row.path], now_s, chart)
                line, style = columns.line(name, one), "dim" if one.late else ""
            text.append("\n")
            text.append(line, style="reverse" if here else style)
        return text


class _Columns(NamedTuple):
    """The widths of the columns, in characters."""

    name: int
    unit: int
    whole: int

    def line(self, name: str, texts: Cells) -> str:
        value = texts.value if len(texts.value) <= VALUE else texts.value[: VALUE - 1] + "…"
        columns = (
            f"{name[: self.name]:<{self.name}} {value:>{VALUE}} {texts.unit:<{self.unit}} {texts.age:>7}"
        )
        return f"{columns}  {texts.remark}"[: self.whole].ljust(self.whole)
