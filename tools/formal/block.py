# SPDX-License-Identifier: BSD-3-Clause
"""What is asked about one block, and a fault that its proof must notice."""

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

    Within `depth` clocks from power-up z3 searches for a violation, within `deep` ABC. Beyond that: with
    `induction` z3 shows that so many good clocks are followed by another; with `pdr` ABC finds an invariant.
    With neither the proof is bounded, and the page says so. Every cover, and the moment at which each part of
    each property counts (`cases`), must be reached within the clocks that are searched; what is proven for
    ever may take more for that, `reach`.

    A part that has a proof of its own, or too much memory for a solver, may be left out: each (entity,
    instance) of `without` is removed, each signal in `loose` loses its driver, and what is not driven has any
    value at any time. What holds then, holds with it. Inputs of the property file show what signals of the
    design have (`seen`), so that it can assume of a loose one what is proven elsewhere. Outputs of it drive
    signals of the design instead of what does (`given`), if it is proven elsewhere that they are equal.
    """

    name: str
    what: str
    depth: int
    mutants: tuple[Mutant, ...]
    deep: int = 0
    reach: int = 0
    induction: int | None = None
    pdr: bool = False
    for_ever: tuple[str, ...] = ()  # too many for `pdr` at once: proven one by one
    generics: Mapping[str, int | str | bool] = field(default_factory=dict)
    without: tuple[tuple[str, str], ...] = ()
    seen: Mapping[str, str] = field(default_factory=dict)  # port: signal
    loose: tuple[str, ...] = ()
    given: Mapping[str, str] = field(default_factory=dict)  # signal: output of the property file
    not_proven: str = ""  # what a reader may expect and does not get
    quick: bool = False  # in the short form too, which is a test
    several_clocks: bool = False  # each an input; depths then count steps, in which any of them may turn

    def __post_init__(self) -> None:
        if self.reach and self.is_bounded:
            raise ValueError(f"{self.name}: what a bounded proof does not search proves nothing: no `reach`")

    @property
    def top(self) -> str:
        """The entity of the property file."""
        return f"{self.name}_formal"

    @property
    def searched(self) -> int:
        """Clocks from power-up that are searched for a violation."""
        return max(self.depth, self.deep)

    @property
    def is_bounded(self) -> bool:
        """Whether nothing is known of the clocks behind those that are searched."""
        return self.induction is None and not self.pdr

    @property
    def reached(self) -> int:
        """Clocks within which every case and every cover must be reached."""
        return self.searched if self.is_bounded else max(self.reach, self.searched)
