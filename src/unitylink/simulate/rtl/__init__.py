# SPDX-License-Identifier: BSD-3-Clause
"""Compiled VHDL as a board, with the endpoints and plants of the twin."""

from __future__ import annotations

from .board import RtlBoard, rtl_configuration
from .build import build_model, compile_netlist
from .design import RtlDesign, RtlModel, design_of

__all__ = [
    "RtlBoard",
    "RtlDesign",
    "RtlModel",
    "build_model",
    "compile_netlist",
    "design_of",
    "rtl_configuration",
]
