# SPDX-License-Identifier: BSD-3-Clause
"""One configuration whose area and clock are measured."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

SEEDS = (1, 2, 3)  # of placements


@dataclass(frozen=True)
class Row:
    """One configuration: the core with its settings, another entity, or the top level of an example."""

    name: str
    what: str
    top: str = "core"
    settings: Mapping[str, int | str | bool] = field(default_factory=dict)  # settings that differ from SMALL
    example: str = ""  # the folder in examples/ with the spec of its generated design
    protocol: str = "classic"  # protocol of that design; a core has it among its settings
    engine: str = "fast"  # engine of the framed protocol in a core
    chips: tuple[str, ...] = ("ice40", "ecp5")
    seeds: tuple[int, ...] = SEEDS
    ecp5_options: tuple[str, ...] = ()  # for nextpnr
    cells_most: int | None = None  # on iCE40
    mhz_least: float | None = None  # on iCE40, the median over the seeds
    memories_most: int | None = None  # on iCE40
    ecp5_mhz_least: float | None = None
