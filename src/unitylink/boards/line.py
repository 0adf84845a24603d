# SPDX-License-Identifier: BSD-3-Clause
"""The baud rate of a design, and whether the clock is fast enough for it."""

from __future__ import annotations

from unitylink.errors import BoardError
from unitylink.spec.model import Spec

CLOCKS_A_BIT = 8  # the fewest for the UART's receiver


def told_baud_hz(spec: Spec) -> int | None:
    """Return the baud rate in the links of the spec, or None if they have none."""
    told = {device.link.baud_hz for device in spec.devices} - {None}
    return told.pop() if len(told) == 1 else None


def check_line(clock_hz: int, baud_hz: int) -> None:
    """Raise BoardError if the UART cannot make `baud_hz` from the design's clock."""
    if baud_hz * CLOCKS_A_BIT > clock_hz:
        raise BoardError(
            f"{baud_hz:,} baud needs a clock of {baud_hz * CLOCKS_A_BIT / 1e6:.6g} MHz and the design has "
            f"{clock_hz / 1e6:.6g} MHz: choose --baud {clock_hz // CLOCKS_A_BIT} "
            f"or --clock-hz {baud_hz * CLOCKS_A_BIT}"
        )
