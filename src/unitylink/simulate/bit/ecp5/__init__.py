# SPDX-License-Identifier: BSD-3-Clause
"""From a bitstream of an ECP5 back to logic, with the chip's description by Project Trellis."""

from __future__ import annotations

from .database import site_at
from .unpack import unpack

__all__ = ["site_at", "unpack"]
