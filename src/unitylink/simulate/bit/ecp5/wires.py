# SPDX-License-Identifier: BSD-3-Clause
"""Which wire drives which: the muxes that a bitstream sets, and what is always connected."""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterator
from functools import cache
from itertools import chain

from unitylink.errors import ToolError

from .configuration import Configuration
from .database import Device, tile_kind

Wire = tuple[int, int, str]  # row, column, name; a wire of the whole chip has the place (-1, -1)

_AWAY = re.compile(r"(?:([NS])(\d+))?(?:([EW])(\d+))?_(.+)")
_SIZE = re.compile(r"(\d+K)_(.+)")
_ROUTED = re.compile(r"CIB\.(\w+)MUX")  # a wire that may be a constant


@cache
def _parsed(name: str) -> tuple[int, int, str, str]:
    """Return how far down and right a wire is, its name there, and which size of chip has it, if not all."""
    size = ""
    if found := _SIZE.fullmatch(name):
        size, name = found.groups()
    if name.startswith("G_") or not (found := _AWAY.fullmatch(name)) or not (found[1] or found[3]):
        return 0, 0, name, size
    down = int(found[2] or 0) * (-1 if found[1] == "N" else 1)
    right = int(found[4] or 0) * (-1 if found[3] == "W" else 1)
    return down, right, found[5], size


class Wires:
    """The wires of a chip with a bitstream.

    `source(wire)` follows the connections back to where they begin: an output of a cell. `live` says of such
    a place whether the cell is in use, because some wires may come from several cells.
    """

    def __init__(self, device: Device, configuration: Configuration) -> None:
        self.device = device
        self.live: Callable[[Wire], bool] = lambda wire: True
        self._set: dict[Wire, Wire] = {}
        self._constant: dict[Wire, str] = {}
        self._gated: set[str] = set()
        self._joined: dict[Wire, list[Wire]] = defaultdict(list)
        self._known: dict[Wire, Wire | str | None] = {}
        in_use = {(tile.row, tile.column, tile.kind) for tile in configuration.tiles}
        for tile in configuration.tiles:
            here = (tile.row, tile.column)
            for sink, source in tile.arcs.items():
                self._connect(here, sink, source)
            for name, value in tile.values.items():
                if value == "DCCA":
                    gate = name.removeprefix("DCC_").removesuffix(".MODE")  # L3
                    self._gated.add(f"G_CLKO_{gate[0]}DCC{gate[1:]}")
                if (found := _ROUTED.fullmatch(name)) and value in "01":
                    # the database names the bits of a reset or a clock that is always 1 by a 0
                    one = value == "1" or found[1].startswith(("JLSR", "JCLK"))
                    self._constant[here[0], here[1], found[1]] = f"{one:d}"
        for (row, column), kinds in device.kinds.items():
            for kind in kinds:
                if kind == "PLC2" and (row, column, kind) not in in_use:
                    continue  # nothing begins in a block of logic that is not used
                about = tile_kind(kind)
                for sink, source in chain(about.joined, about.default.items()):
                    self._join((row, column), sink, source)
        for quadrant in device.quadrants:
            for number in range(16):  # clocks of a quarter of the chip
                self._joined[-1, -1, f"{quadrant}HPRX{number:02}00"].append(
                    (-1, -1, f"G_{quadrant}PCLK{number}")
                )

    def wire(self, row: int, column: int, name: str) -> Wire | None:
        """Return the wire that a tile calls `name`, or None if this chip has none."""
        down, right, name, size = _parsed(name)
        if size and size != self.device.size:
            return None
        if not name.startswith("G_"):
            return row + down, column + right, name
        if name.startswith("G_HPBX"):
            side, tap = self.device.tap(column)
            return row, tap, f"{side}_{name[2:]}"
        if name.startswith("G_VPTX"):
            tap = self.device.spines.get((row, column), column)
            return -1, tap, f"{self.device.quadrant(row, column)}{name[2:]}"
        if name.startswith("G_HPRX"):
            return -1, -1, f"{self.device.quadrant(row, column)}{name[2:]}"
        return -1, -1, name

    def _connect(self, here: tuple[int, int], sink: str, source: str) -> None:
        to, whence = self.wire(*here, sink), self.wire(*here, source)
        if to is None or whence is None:
            raise ToolError(f"the bitstream connects a wire that its chip does not have: {sink}, {source}")
        self._set[to] = whence

    def _join(self, here: tuple[int, int], sink: str, source: str) -> None:
        to, whence = self.wire(*here, sink), self.wire(*here, source)
        if to is not None and whence is not None and to != whence:
            self._joined[to].append(whence)

    def source(self, wire: Wire) -> Wire | str | None:
        """Return the output of a cell that drives `wire`, or "0" or "1", or None if nothing drives it."""
        if wire in self._known:
            return self._known[wire]
        self._known[wire] = None  # a circle of wires that nothing drives
        self._known[wire] = found = self._source(wire)
        return found

    def _source(self, wire: Wire) -> Wire | str | None:
        if wire in self._constant:
            return self._constant[wire]
        if wire in self._set:
            if (begin := self.source(self._set[wire])) is None:
                raise ToolError(
                    "the bitstream uses a block of the chip that is not modelled: nothing drives "
                    f"{wire[2]} of row {wire[0]}, column {wire[1]}"
                )
            return begin
        found = {begin for begin in self._begins(wire) if begin is not None}
        if len(found) > 1:
            row, column, name = wire
            raise ToolError(f"the bitstream drives {name} of row {row}, column {column} from several cells")
        return next(iter(found), None)

    def _begins(self, wire: Wire) -> Iterator[Wire | str | None]:
        if wire[2].startswith("G_CLKO_"):  # behind the gate of a clock
            if wire[2] in self._gated:
                raise ToolError("the bitstream has a clock with an enable (DCCA): that is not modelled")
            yield self.source((*wire[:2], wire[2].replace("CLKO", "CLKI", 1)))
        elif not self._joined.get(wire):
            yield wire if self.live(wire) else None
        for before in self._joined.get(wire, ()):
            yield self.source(before)
