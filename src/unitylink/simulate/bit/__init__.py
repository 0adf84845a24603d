# SPDX-License-Identifier: BSD-3-Clause
"""A bitstream as a board: unpacked, compiled, and with the endpoints and plants of the twin."""

from __future__ import annotations

from .board import BitBoard
from .chip import Chip
from .pins import Pins
from .place import Placed, placed, placed_in
from .unpack import unpack

__all__ = ["BitBoard", "Chip", "Pins", "Placed", "placed", "placed_in", "unpack"]
