# SPDX-License-Identifier: BSD-3-Clause
"""A project for the tools of a vendor: what its scripts and constraints are made from."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from unitylink.gateware import Port, gateware_folder
from unitylink.generate.quoting import Tcl

SITE = "SITE"  # stands for the place of a pin that the user has to fill in


@dataclass(frozen=True)
class Project:
    """What the scripts need to know."""

    name: str
    top: str
    part: str
    clock_hz: int
    baud_hz: int
    generics: Mapping[str, int]
    sources: tuple[tuple[str, Path], ...]  # VHDL, each file with its library
    verilog: tuple[Path, ...]  # the top level, if pins go both ways; for open tools the whole netlist
    pins: Mapping[str, str]  # bit of a port -> site, or "" if the user has to fill it in
    ports: tuple[Port, ...]  # ports of the top level
    clock: str
    physical: str

    def places(self) -> Iterator[tuple[str, str, str]]:
        """Yield (mark, bit, site) of each pin. The mark is "# " if the site is to be filled in."""
        for bit, site in self.pins.items():
            yield ("", bit, site) if site else ("# ", bit, SITE)


def crossings(ending: str) -> Path:
    """Return the constraints of all clock crossings of the gateware."""
    return (gateware_folder() / "constraints" / f"crossings.{ending}").resolve()


def tcl_text(lines: Sequence[Tcl]) -> str:
    """Return a file of these lines."""
    return Tcl("").join(Tcl.of("{}\n", line) for line in lines)
