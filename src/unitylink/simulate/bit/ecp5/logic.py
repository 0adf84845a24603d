# SPDX-License-Identifier: BSD-3-Clause
"""The blocks of logic of an ECP5 as Verilog: four slices of two LUTs and two flip-flops.

What a slice does with its settings is in Lattice's technical note TN1265 and in the cells of yosys.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Protocol

from unitylink.errors import ToolError

from .configuration import Tile
from .database import tile_kind
from .wires import Wire

SLICES = "ABCD"
OUTPUT = re.compile(r"(F|Q)([0-7])_SLICE|(F5|FX|FCO)([A-D])_SLICE|(FCO)_SLICE|(WA?DO)([0-3])C_SLICE")
_RAM_INPUTS = {"WDO": "CADB", "WADO": "DBCA"}  # of slice C, for bits 0 to 3; its second LUT has the data


class Nets(Protocol):
    """What a cell needs of the netlist: the net of a wire, or a constant."""

    def net(self, wire: Wire, floating: str) -> str: ...
    def clock(self, wire: Wire) -> bool: ...


class Block:
    """A block of logic with the settings of `tile`."""

    def __init__(self, tile: Tile, nets: Nets) -> None:
        self._tile = tile
        self._nets = nets
        self._defaults = tile_kind(tile.kind).values

    def gives(self, output: str) -> bool:
        """Tell whether the wire `output` is one of a cell. A slice has a carry only if it adds."""
        found = OUTPUT.fullmatch(output)
        carry = found and (found[4] if found[3] == "FCO" else found[5] and "D")
        return found is not None and (not carry or self._value(f"SLICE{carry}.MODE") == "CCU2")

    def cell(self, output: str, made: str) -> Iterator[str]:
        """Print the cell whose output is the wire `output`. Its net is `made`."""
        found = OUTPUT.fullmatch(output)
        assert found is not None
        if found[1] == "Q":
            yield from self._flip_flop(int(found[2]), made)
        elif found[1] == "F":
            yield from self._lut(int(found[2]), made)
        elif found[3] == "F5":
            low = 2 * SLICES.index(found[4])
            yield self._chosen(made, f"M{low}", f"F{low}_SLICE", f"F{low + 1}_SLICE")
        elif found[3] == "FX":
            slice_ = found[4]
            yield self._chosen(
                made, f"M{2 * SLICES.index(slice_) + 1}", f"FXA{slice_}_SLICE", f"FXB{slice_}_SLICE"
            )
        elif found[6]:
            bit = int(found[7])
            lut = 5 if found[6] == "WDO" else 4
            yield f"assign {made} = {self._input(_RAM_INPUTS[found[6]][bit], lut)};"
        else:
            yield self._carry(SLICES.index(found[4] or "D"), made)

    def _value(self, name: str) -> str:
        return self._tile.values.get(name, self._defaults.get(name, ""))

    def _at(self, wire: str, floating: str = "1'b1") -> str:
        return self._nets.net((self._tile.row, self._tile.column, wire), floating)

    def _input(self, letter: str, lut: int) -> str:
        pin = f"{letter}{lut % 2}"
        if self._value(f"SLICE{SLICES[lut // 2]}.{pin}MUX") == "1":
            return "1'b1"
        return self._at(f"{letter}{lut}_SLICE")

    def _control(self, name: str, wire: str, floating: str) -> str:
        """Return a control input. `name` is the setting that may invert it or make it a constant."""
        value = self._value(name)
        if value in ("0", "1"):
            return f"1'b{value}"
        net = self._at(wire, floating)
        return f"~{net}" if value == "INV" else net

    def _inputs(self, lut: int) -> list[str]:
        return [self._input(letter, lut) for letter in "ABCD"]

    def _mode(self, lut: int) -> str:
        return self._value(f"SLICE{SLICES[lut // 2]}.MODE")

    def _table(self, lut: int) -> int:
        return int(self._value(f"SLICE{SLICES[lut // 2]}.K{lut % 2}.INIT"), 2)

    def _lut(self, lut: int, made: str) -> Iterator[str]:
        mode = self._mode(lut)
        if mode == "DPRAM":
            yield from self._small_ram(lut, made)
        elif mode == "CCU2":
            table = looked_up(self._table(lut), self._inputs(lut))
            yield f"assign {made} = {table} ^ {self._carry_gated(lut)};"
        else:
            yield f"assign {made} = {looked_up(self._table(lut), self._inputs(lut))};"

    def _chosen(self, made: str, pin: str, low: str, high: str) -> str:
        slice_ = SLICES[int(pin[1]) // 2]
        select = (
            "1'b1" if self._value(f"SLICE{slice_}.M{int(pin[1]) % 2}MUX") == "1" else self._at(f"{pin}_SLICE")
        )
        return f"assign {made} = {select} ? {self._at(high)} : {self._at(low)};"

    def _injected(self, lut: int) -> bool:
        return self._value(f"SLICE{SLICES[lut // 2]}.CCU2.INJECT1_{lut % 2}") == "YES"

    def _carry_in(self, lut: int) -> str:
        if lut % 2:
            return self._carry_through(lut - 1)
        slice_ = SLICES[lut // 2]
        return self._at("FCI_SLICE" if slice_ == "A" else f"FCI{slice_}_SLICE")

    def _carry_gated(self, lut: int) -> str:
        return "1'b0" if self._injected(lut) else self._carry_in(lut)

    def _carry_through(self, lut: int) -> str:
        """Return the carry behind one half of a slice."""
        inputs, table = self._inputs(lut), self._table(lut)
        lower = "1'b0" if self._injected(lut) else looked_up(table & 15, inputs[:2])
        return f"({looked_up(table, inputs)} ? {self._carry_in(lut)} : {lower})"

    def _carry(self, slice_: int, made: str) -> str:
        return f"assign {made} = {self._carry_through(2 * slice_ + 1)};"

    def _small_ram(self, lut: int, made: str) -> Iterator[str]:
        """Print one bit of sixteen words. Its address inputs are those of a LUT."""
        slice_ = SLICES[lut // 2]
        clock = f"WCK{lut // 2}_SLICE"
        self._check_clock(clock, "CLK1")
        wad = [self._at(f"WAD{bit}{slice_}_SLICE") for bit in range(4)]
        a, b, c, d = self._inputs(lut)
        enable = self._control(f"SLICE{slice_}.WREMUX", f"WRE{lut // 2}_SLICE", "1'b0")
        yield f"reg [15:0] ram_{made} = 16'd{self._table(lut)};"
        data = self._at(f"WD{lut % 2}{slice_}_SLICE")
        yield f"assign {made} = ram_{made}[{{{d}, {c}, {b}, {a}}}];"
        yield (
            f"always @(posedge clock) if ({enable}) "
            f"ram_{made}[{{{wad[0]}, {wad[2]}, {wad[1]}, {wad[3]}}}] <= {data};"
        )

    def _check_clock(self, wire: str, clock: str) -> None:
        row, column = self._tile.row, self._tile.column
        if not self._nets.clock((row, column, wire)):
            raise ToolError(f"the bitstream has a flip-flop without a clock: row {row}, column {column}")
        if self._value(f"{clock}.CLKMUX") != "CLK":
            raise ToolError(
                "the bitstream has a flip-flop on a falling edge of its clock: only one clock can be run"
            )

    def _flip_flop(self, number: int, made: str) -> Iterator[str]:
        slice_, index = SLICES[number // 2], number // 2
        setting = f"SLICE{slice_}.REG{number % 2}"
        if self._value(f"{setting}.LSRMODE") == "PRLD":
            raise ToolError("the bitstream has a flip-flop that is loaded by its reset: that is not modelled")
        clock, reset = (self._tile.arcs.get(f"MUX{name}{index}", "") for name in ("CLK", "LSR"))
        self._check_clock(f"CLK{index}_SLICE", clock)
        first = f"1'b{self._value(f'{setting}.REGSET') == 'SET':d}"
        data = f"DI{number}_SLICE" if self._value(f"{setting}.SD") == "1" else f"M{number}_SLICE"
        enable = self._control(f"SLICE{slice_}.CEMUX", f"CE{index}_SLICE", "1'b1")
        clear = self._control(f"{reset}.LSRMUX", f"LSR{index}_SLICE", "1'b0") if reset else "1'b0"
        at_once = bool(reset) and self._value(f"{reset}.SRMODE") == "ASYNC"
        yield f"reg q_{made} = {first};"
        yield f"assign {made} = q_{made};"
        step = f"if ({enable}) q_{made} <= {self._at(data)};"
        if clear == "1'b0":
            yield f"always @(posedge clock) {step}"
        else:
            edge = f" or posedge clear_{made}" if at_once else ""
            yield f"wire clear_{made} = {clear};"
            yield f"always @(posedge clock{edge}) if (clear_{made}) q_{made} <= {first}; else {step}"


def looked_up(table: int, inputs: list[str]) -> str:
    """Return an expression of what a LUT says. `table` has the bit for the inputs at their place as a number.

    >>> looked_up(0b1000, ["a", "b"])
    '(b & a)'
    >>> looked_up(0b0110, ["a", "b"])
    '(b ? ~a : a)'
    """
    if not inputs:
        return f"1'b{table & 1}"
    *rest, last = inputs
    half = 1 << len(rest)
    low, high = table & ((1 << half) - 1), table >> half
    if last in ("1'b0", "1'b1") or low == high:
        return looked_up(high if last == "1'b1" else low, rest)
    zero, one = looked_up(low, rest), looked_up(high, rest)
    if (zero, one) == ("1'b0", "1'b1"):
        return last
    if (zero, one) == ("1'b1", "1'b0"):
        return f"~{last}"
    if zero == "1'b0":
        return f"({last} & {one})"
    if one == "1'b0":
        return f"(~{last} & {zero})"
    if zero == "1'b1":
        return f"(~{last} | {one})"
    if one == "1'b1":
        return f"({last} | {zero})"
    return f"({last} ? {one} : {zero})"
