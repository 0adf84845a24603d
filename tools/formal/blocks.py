# SPDX-License-Identifier: BSD-3-Clause
"""What is proven: a row a block, with how deep, and the faults each proof must notice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Mutant:
    """A seeded fault: one text of one VHDL file, which occurs there once, becomes another."""

    file: str  # of gateware/, by its bare name
    old: str
    new: str


@dataclass(frozen=True)
class Block:
    """One property file, gateware/formal/<name>_formal.vhd, and what is asked of the solvers.

    Within `depth` clocks from power-up z3 searches for a violation, and every cover must be reached. Beyond
    that, any of: with `induction` z3 shows that so many good clocks are followed by another; with `pdr` ABC
    finds an invariant; `deep` is how many clocks ABC searches. With neither of the first two the proof is
    shallow and the page says so.
    """

    name: str
    what: str
    depth: int
    mutants: tuple[Mutant, ...]
    deep: int = 0
    induction: int | None = None
    pdr: bool = False
    generics: Mapping[str, int | str | bool] = field(default_factory=dict)
    not_proven: str = ""  # what a reader may expect and does not get
    quick: bool = False  # in the short form too, which is a test

    @property
    def top(self) -> str:
        """The entity of the property file."""
        return f"{self.name}_formal"

    @property
    def searched(self) -> int:
        """Clocks from power-up that were searched for a violation."""
        return max(self.depth, self.deep)


BLOCKS = (
    Block(
        "fifo",
        "`common/fifo`, 4 words of 2 bits",
        depth=10,
        pdr=True,
        quick=True,
        not_proven="other depths and widths: the proof is of the entity with these generics",
        mutants=(
            Mutant("fifo.vhd", "store <= write_valid and not full;", "store <= write_valid;"),
            Mutant("fifo.vhd", "load or (loaded and not read_ready)", "load or loaded"),
            Mutant("fifo.vhd", "load  <= not empty and", "load  <= "),
        ),
    ),
)
