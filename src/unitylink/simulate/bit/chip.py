# SPDX-License-Identifier: BSD-3-Clause
"""A bitstream as logic."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

CELLS = Path(__file__).with_name("cells.v")  # the models that the logic needs


@dataclass(frozen=True)
class Chip:
    """A bitstream as the Verilog module `chip`.

    `clock` is its clock, `clock_hz` the rate of it on the board. For each pin S of `inputs` there is an input
    `pin_S_in`. For each of `outputs` there are `pin_S_out` and `pin_S_drive`. A pin in both goes both ways.
    """

    verilog: str
    clock_hz: int
    inputs: tuple[str, ...]
    outputs: tuple[str, ...]
