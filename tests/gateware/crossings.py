# SPDX-License-Identifier: BSD-3-Clause
"""Finds where signals of a netlist enter a clock domain: each register, and the sources that reach it."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from unitylink.gateware import run_tool

_SCRIPT = (
    "read_verilog {verilog}; hierarchy -check -top {top}; proc; flatten; opt_clean; opt_dff; simplemap; "
    "opt_clean; write_json {made}"
)
_REGISTER = re.compile(r"\$_(S|AL)?DFF\w*_$")  # registers of one bit, as `simplemap` leaves them
_MADE_UP = re.compile(r"(^|\.)n\d+_\w+$")  # by GHDL
_RESET_BY_CLOCK = "$_SDFF"

Source = tuple[str, str]  # ("clock" or "pin", its name)


@dataclass(frozen=True)
class Register:
    """A bit of a register, in the names of the VHDL: `link.uart.receiver.line_synchroniser.first`."""

    names: tuple[str, ...]
    clock: str
    data: frozenset[Source]  # sources that reach its data input …
    choice: frozenset[Source]  # … its enable or its synchronous reset
    clears: frozenset[Source]  # … and its asynchronous reset
    direct: bool  # true if nothing or an inverter, which has no glitches, is before the data input


class Netlist:
    """The registers of the entity `top` of a Verilog netlist, flattened by yosys in `folder`.

    Netlist(netlist("uart", assertions=False), "uart", folder).registers
    """

    def __init__(self, verilog: str, top: str, folder: Path) -> None:
        source, made = folder / f"{top}.v", folder / f"{top}.json"
        source.write_text(verilog, encoding="utf-8")
        ended = run_tool(["yosys", "-q", "-p", _SCRIPT.format(verilog=source, top=top, made=made)])
        assert ended.code == 0, ended.err[-2000:]
        self._module: Mapping[str, Any] = json.loads(made.read_text(encoding="utf-8"))["modules"][top]
        self._sources: dict[int, frozenset[Source]] = {}
        self._fill()

    @cached_property
    def _names(self) -> dict[int, list[str]]:
        found: dict[int, list[str]] = {}
        for name, net in self._module["netnames"].items():
            for bit in net["bits"]:
                if isinstance(bit, int) and not _MADE_UP.search(name):
                    found.setdefault(bit, []).append(name)
        return found

    @cached_property
    def _pins(self) -> dict[int, str]:
        ports = self._module["ports"].items()
        return {
            bit: name
            for name, port in ports
            if port["direction"] == "input"
            for bit in port["bits"]
            if isinstance(bit, int)
        }

    @property
    def inputs(self) -> set[str]:
        return set(self._pins.values())

    def _clock(self, bit: int) -> str:
        return self._pins.get(bit) or min(self._names[bit])

    def _fill(self) -> None:
        """Find, for all bits, which pins, registers and memories reach them through logic."""
        given: dict[Source, set[int]] = {}
        for bit, name in self._pins.items():
            given.setdefault(("pin", name), set()).add(bit)
        read: dict[int, set[int]] = {}  # bit -> bits that the logic makes from it
        for cell in self._module["cells"].values():
            pins, outputs = cell["connections"], self._bits(cell, "output")
            if _REGISTER.match(cell["type"]):
                given.setdefault(("clock", self._clock(pins["C"][0])), set()).update(outputs)
            elif cell["type"].startswith("$memwr"):
                written = self._read_from(cell["parameters"]["MEMID"])
                given.setdefault(("clock", self._clock(pins["CLK"][0])), set()).update(written)
            else:
                for bit in self._bits(cell, "input"):
                    read.setdefault(bit, set()).update(outputs)
        for source, start in given.items():
            reached, waiting = set(start), list(start)
            while waiting:
                new = read.get(waiting.pop(), set()) - reached
                reached |= new
                waiting += new
            for bit in reached:
                self._sources[bit] = self._sources.get(bit, frozenset()) | {source}

    def _read_from(self, memory: str) -> tuple[int, ...]:
        """Return the bits that are read from a memory."""
        return tuple(
            bit
            for cell in self._module["cells"].values()
            if cell["type"].startswith("$memrd") and cell["parameters"]["MEMID"] == memory
            for bit in self._bits(cell, "output")
        )

    def _bits(self, cell: Mapping[str, Any], way: str) -> tuple[int, ...]:
        ports = (port for port, its in cell["port_directions"].items() if its == way)
        return tuple(bit for port in ports for bit in cell["connections"][port] if isinstance(bit, int))

    def _of(self, bits: list[int | str]) -> frozenset[Source]:
        return frozenset().union(
            *(self._sources.get(bit, frozenset()) for bit in bits if isinstance(bit, int))
        )

    @property
    def registers(self) -> Iterator[Register]:
        """Every bit of every register, and every write port of a memory."""
        for cell in self._module["cells"].values():
            pins = cell["connections"]
            if cell["type"].startswith("$memwr"):
                yield Register(
                    names=(cell["parameters"]["MEMID"].lstrip("\\"),),
                    clock=self._clock(pins["CLK"][0]),
                    data=self._of(pins["DATA"]) | self._of(pins["ADDR"]),
                    choice=self._of(pins["EN"]),
                    clears=frozenset(),
                    direct=False,
                )
            elif _REGISTER.match(cell["type"]):
                by_clock = cell["type"].startswith(_RESET_BY_CLOCK)
                choice = [*pins.get("E", []), *(pins.get("R", []) if by_clock else [])]
                clears = [*pins.get("S", []), *pins.get("L", []), *([] if by_clock else pins.get("R", []))]
                taken, given = pins["D"][0], pins["Q"][0]
                yield Register(
                    names=tuple(self._names.get(given, ())),
                    clock=self._clock(pins["C"][0]),
                    data=self._of([taken]),
                    choice=self._of(choice),
                    clears=self._of(clears),
                    direct=taken in self._whole or self._inverted.get(taken) in self._whole,
                )

    @cached_property
    def _whole(self) -> frozenset[int]:
        """The bits that come out of no logic: of pins and registers."""
        stored = {
            bit
            for cell in self._module["cells"].values()
            if _REGISTER.match(cell["type"])
            for bit in cell["connections"]["Q"]
        }
        return frozenset(stored | self._pins.keys())

    @cached_property
    def _inverted(self) -> dict[int, int]:
        """What comes out of an inverter, and what goes in."""
        cells = (cell for cell in self._module["cells"].values() if cell["type"] == "$_NOT_")
        return {cell["connections"]["Y"][0]: cell["connections"]["A"][0] for cell in cells}
