# SPDX-License-Identifier: BSD-3-Clause
"""The plants that come with the library."""

from __future__ import annotations

from .axis import Axis, Joint
from .loopback import LoopbackPlant
from .ramp import RampPlant
from .scara import ScaraPlant
from .servos import ServoNames, ServoPlant
from .words import Echo, Ramp, WordPlant

__all__ = [
    "Axis",
    "Echo",
    "Joint",
    "LoopbackPlant",
    "Ramp",
    "RampPlant",
    "ScaraPlant",
    "ServoNames",
    "ServoPlant",
    "WordPlant",
]
