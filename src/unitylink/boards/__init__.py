# SPDX-License-Identifier: BSD-3-Clause
"""FPGA boards: which there are, and how a spec becomes a bitstream for one."""

from __future__ import annotations

from .flow import Order, build_bitstream
from .manifest import Board, board_names, load_board
from .report import Report, read_report

__all__ = ["Board", "Order", "Report", "board_names", "build_bitstream", "load_board", "read_report"]
