# SPDX-License-Identifier: BSD-3-Clause
"""The netlist of an ECP5's bitstream, as Verilog with one clock and plain pins."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import product

from unitylink.errors import BoardError, ToolError

from ..chip import Chip
from . import database, logic, memory
from .configuration import Configuration, Tile, read
from .database import DEVICES, Device, tile_kind
from .wires import Wire, Wires

_PLL_OUTPUT = "JCLKOP_PLL"
_LOCKS = ("JLOCK_PLL", "JINTLOCK_PLL")
_Memory = tuple[tuple[int, int], dict[str, str]]  # its place and its settings


def unpack(bitstream: bytes, *, device: str, package: str | None, clock_site: str, clock_hz: int) -> Chip:
    """Return the logic that `bitstream` puts into an ECP5 (`device`, `package` as nextpnr names them).

    `clock_hz` is the frequency at the pin `clock_site`. If the bitstream has a PLL, its dividers say what
    becomes of it. Raises ToolError if a program is missing, or if the bitstream has a part that is not
    modelled. Raises BoardError if the file is not a bitstream of this chip.
    """
    if device not in DEVICES:
        raise BoardError(f"Project Trellis has no chip {device}; it has {', '.join(DEVICES)}")
    configuration = read(bitstream)
    if configuration.device != DEVICES[device]:
        raise BoardError(f"it is a bitstream of an {configuration.device}, not of an {DEVICES[device]}")
    return logic_of(configuration, package, clock_site, clock_hz)


def logic_of(configuration: Configuration, package: str | None, clock_site: str, clock_hz: int) -> Chip:
    """Return the logic that `configuration` makes. Raises ToolError."""
    chip = database.device(configuration.device, package)
    return _Netlist(configuration, chip, clock_site, clock_hz).chip()


@dataclass(frozen=True)
class _Pin:
    site: str
    row: int
    column: int
    letter: str
    way: str  # INPUT, OUTPUT or BIDIR

    def wire(self, name: str) -> Wire:
        return self.row, self.column, f"{name}{self.letter}_PIO"


class _Netlist:
    """Goes from the outputs back to the inputs, and prints each cell that it meets."""

    def __init__(self, configuration: Configuration, chip: Device, clock_site: str, clock_hz: int) -> None:
        self._clock_site, self._clock_hz = clock_site, clock_hz
        self._wires = Wires(chip, configuration)
        self._wires.live = self._is_live
        self._tiles: dict[tuple[int, int], list[Tile]] = {}
        for tile in configuration.tiles:
            self._tiles.setdefault((tile.row, tile.column), []).append(tile)
        self._blocks = {
            (tile.row, tile.column): logic.Block(tile, self)
            for tile in configuration.tiles
            if tile.kind == "PLC2"
        }
        self._contents = configuration.memories
        self._memories = dict(_memories(chip, self._tiles))
        self._plls = dict(_plls(self._wires, configuration))
        self._pins = {pin.wire("JPADDI"): pin for pin in self._pins_of(chip)}
        self._nets: dict[Wire, str] = {}
        self._new: list[Wire] = []
        self._clocks: set[Wire] = set()
        self._inputs: list[str] = []  # sites

    def _pins_of(self, chip: Device) -> Iterator[_Pin]:
        for site, (row, column, letter) in chip.sites.items():
            if way := self._way(row, column, letter):
                yield _Pin(site, row, column, letter, way)

    def _way(self, row: int, column: int, letter: str) -> str:
        """Return which way a pin goes. Its settings are in tiles beside it."""
        rows, columns = (3, 1) if self._is_side(row, column) else (2 if row == 0 else 1, 2)
        found = {
            kind.partition("_")[0]
            for beside in product(range(row, row + rows), range(column, column + columns))
            for tile in self._tiles.get(beside, ())
            if (kind := tile.values.get(f"PIO{letter}.BASE_TYPE"))
        }
        return next((way for way in ("BIDIR", "OUTPUT", "INPUT") if way in found), "")

    def _is_side(self, row: int, column: int) -> bool:
        kinds = self._wires.device.kinds.get((row, column), ())
        return any(kind.startswith(("PICL", "PICR", "MIB_CIB_LR")) for kind in kinds)

    def _is_live(self, wire: Wire) -> bool:
        row, column, name = wire
        if name.endswith("_SLICE"):
            return (row, column) in self._blocks and self._blocks[row, column].gives(name)
        if memory.OUTPUT.fullmatch(name):
            return (row, column) in self._memories
        if name == _PLL_OUTPUT or name in _LOCKS:
            return (row, column) in self._plls
        pin = self._pins.get(wire)
        return pin is not None and pin.way != "OUTPUT"

    def net(self, wire: Wire, floating: str) -> str:
        """Return the net that drives `wire`, or a constant. It is `floating` if nothing drives it."""
        begin = self._wires.source(wire)
        if begin is None:
            return floating
        if isinstance(begin, str):
            return f"1'b{begin}"
        if begin not in self._nets:
            self._nets[begin] = f"n{len(self._nets)}"
            self._new.append(begin)
        return self._nets[begin]

    def clock(self, wire: Wire) -> bool:
        """Say that `wire` is the clock of a cell. Return False if it never ticks."""
        begin = self._wires.source(wire)
        if begin is None or isinstance(begin, str):
            return False
        self._clocks.add(begin)
        return True

    def chip(self) -> Chip:
        ports, ends, outputs = ["input clock"], [], []
        for pin in self._pins.values():
            if pin.way == "INPUT":
                continue
            value = self.net(pin.wire("PADDO"), "")
            if not value:
                continue
            drive = self.net(pin.wire("PADDT"), "1'b0") if pin.way == "BIDIR" else "1'b0"
            ports += [f"output pin_{pin.site}_out", f"output pin_{pin.site}_drive"]
            ends += [f"assign pin_{pin.site}_out = {value};", f"assign pin_{pin.site}_drive = ~{drive};"]
            outputs.append(pin.site)
        cells: list[str] = []
        seen: set[tuple[int, int]] = set()
        while self._new:
            cells += self._cell(self._new.pop(), seen)
        clock_hz = self._made_hz()
        ports += [f"input pin_{site}_in" for site in self._inputs]
        nets = [f"wire {net};" for net in self._nets.values()]
        body = "\n".join((*nets, *cells, *ends))
        return Chip(
            f"module chip({', '.join(ports)});\n{body}\nendmodule\n",
            clock_hz,
            tuple(self._inputs),
            tuple(outputs),
        )

    def _cell(self, begin: Wire, seen: set[tuple[int, int]]) -> Iterator[str]:
        row, column, name = begin
        made = self._nets[begin]
        if (pin := self._pins.get(begin)) is not None:
            self._inputs.append(pin.site)
            outside = f"pin_{pin.site}_in"
            both = f"pin_{pin.site}_drive ? pin_{pin.site}_out : {outside}"
            yield f"assign {made} = {both if pin.way == 'BIDIR' else outside};"
        elif found := memory.OUTPUT.fullmatch(name):
            ram = f"ram_{row}_{column}"
            if (row, column) not in seen:
                seen.add((row, column))
                values = self._memories[row, column]
                first = self._contents.get(int(values["WID"][::-1], 2), ())
                yield from memory.Memory(row, column, values, first, self).cell(ram)
            yield f"assign {made} = {ram}_{found[1].lower()}[{found[2]}];"
        elif name in _LOCKS:
            yield f"unitylink_lock lock_{made}(.clock(clock), .lock({made}));"
        elif name == _PLL_OUTPUT:
            yield f"assign {made} = clock;"
        else:
            yield from self._blocks[row, column].cell(name, made)

    def _made_hz(self) -> int:
        """Return the rate of the only clock."""
        if len(self._clocks) != 1:
            names = ", ".join(
                sorted(f"{name} of row {row}, column {column}" for row, column, name in self._clocks)
            )
            raise ToolError(f"only one clock can be run, and the bitstream has {len(self._clocks)}: {names}")
        begin = next(iter(self._clocks))
        place = begin[:2]
        if begin[2] == _PLL_OUTPUT:
            values = {**tile_kind(self._plls[place].kind).values, **self._plls[place].values}
            if self._wires.source((*place, "CLKFB_PLL")) != begin:
                raise ToolError(
                    "the PLL of the bitstream has another feedback than its first output: not modelled"
                )
            divided, times = (int(values[name], 2) + 1 for name in ("CLKI_DIV", "CLKFB_DIV"))
            begin_pin, rate = self._wires.source((*place, "CLKI_PLL")), self._clock_hz * times / divided
        else:
            begin_pin, rate = begin, float(self._clock_hz)
        pin = self._pins.get(begin_pin) if isinstance(begin_pin, tuple) else None
        if pin is None or pin.site != self._clock_site:
            whence = pin.site if pin else begin_pin
            raise ToolError(f"the clock of the bitstream comes from {whence}, not from {self._clock_site}")
        if self._clock_site in self._inputs:
            raise ToolError("the bitstream uses the pin of its clock as a signal: that is not modelled")
        return round(rate)


def _plls(wires: Wires, configuration: Configuration) -> Iterator[tuple[tuple[int, int], Tile]]:
    """Return the PLLs that are in use, by the place of their wires."""
    for tile in configuration.tiles:
        if tile.values.get("MODE") == "EHXPLLL":
            for _, source in tile_kind(tile.kind).joined:
                if source.endswith(_PLL_OUTPUT) and (wire := wires.wire(tile.row, tile.column, source)):
                    yield wire[:2], tile


def _memories(chip: Device, tiles: Mapping[tuple[int, int], list[Tile]]) -> Iterator[_Memory]:
    """Return the block RAMs that are in use. A block RAM has its settings in two or three tiles."""
    for (row, column), kinds in chip.kinds.items():
        for number in filter(None, (tile_kind(kind).memory for kind in kinds)):
            places = [
                (row, beside) for beside in range(column + 2, column - 1, -1)
            ]  # the first tile says most
            values: dict[str, str] = {}
            told: dict[str, str] = {}
            for place in places:
                for kind in chip.kinds.get(place, ()):
                    values |= _of(number, tile_kind(kind).values)
                for tile in tiles.get(place, ()):
                    set_here = _of(number, tile.values)
                    if f"{number}.MODE" in tile_kind(tile.kind).vague and "MODE" in set_here:
                        set_here["MODE"] = told.get("MODE", "DP16KD")
                    told |= set_here
            if "MODE" in told:
                number_bits = zip(told.get("WID", values["WID"]), values["WID"], strict=True)
                told["WID"] = "".join(str(int(bit != first)) for bit, first in number_bits)
                yield (row, column), {**values, **told}


def _of(cell: str, values: Mapping[str, str]) -> dict[str, str]:
    """Return the settings of a cell. A setting whose bits have no name there is left out."""
    return {
        name.partition(".")[2]: value
        for name, value in values.items()
        if name.startswith(f"{cell}.") and value not in ("NONE", "_NONE_")
    }
