# SPDX-License-Identifier: BSD-3-Clause
"""The plants that come with the library."""

from __future__ import annotations

from .loopback import LoopbackPlant
from .ramp import RampPlant
from .scara import ScaraPlant
from .words import Echo, Ramp, WordPlant

__all__ = ["Echo", "LoopbackPlant", "Ramp", "RampPlant", "ScaraPlant", "WordPlant"]
