# SPDX-License-Identifier: BSD-3-Clause
"""The FPGA half as Python sees it: where its VHDL is, and the netlist GHDL makes of it."""

from __future__ import annotations

from .ghdl import Ghdl
from .netlist import netlist
from .sources import gateware_folder, gateware_sources

__all__ = ["Ghdl", "gateware_folder", "gateware_sources", "netlist"]
