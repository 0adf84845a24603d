# SPDX-License-Identifier: BSD-3-Clause
"""The fields of a word of `bus_sequencer.vhd`. One with CONTROL has its operation in bits 13 to 11."""

from __future__ import annotations

CHECK, CONTROL = 0x4000, 0xC000
FIRST, LAST, RECEIVE, KEEP, LANE = 0x2000, 0x1000, 0x0800, 0x0400, 0x0100
