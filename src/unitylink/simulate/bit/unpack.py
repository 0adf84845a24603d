# SPDX-License-Identifier: BSD-3-Clause
"""From a bitstream back to logic, for the chip of a board."""

from __future__ import annotations

from unitylink.boards import Board

from . import ecp5, ice40
from .chip import Chip

UNPACKERS = {"ice40": ice40.unpack, "ecp5": ecp5.unpack}


def unpack(bitstream: bytes, board: Board) -> Chip:
    """Return the logic that `bitstream` puts into the chip of `board`.

    Raises ToolError if a program is missing, or if the bitstream has a part that is not modelled. Raises
    BoardError if the file is not a bitstream of this chip.
    """
    return UNPACKERS[board.family](
        bitstream,
        device=board.device,
        package=board.package,
        clock_site=board.pins[board.clock_pin].site,
        clock_hz=board.clock_hz,
    )
