# SPDX-License-Identifier: BSD-3-Clause
"""The FPGA half as Python sees it: the place of its VHDL, and the netlist that GHDL makes of it."""

from __future__ import annotations

from .export import export_gateware
from .ghdl import Ghdl
from .library import LIBRARY, DesignGhdl
from .netlist import netlist
from .ports import Port, ports_of
from .programs import find_program, map_cells, run_tool
from .sources import (
    bench_sources,
    every_source,
    gateware_folder,
    gateware_sources,
    property_sources,
    simulation_sources,
)

__all__ = [
    "LIBRARY",
    "DesignGhdl",
    "Ghdl",
    "Port",
    "bench_sources",
    "every_source",
    "export_gateware",
    "find_program",
    "gateware_folder",
    "gateware_sources",
    "map_cells",
    "netlist",
    "ports_of",
    "property_sources",
    "run_tool",
    "simulation_sources",
]
