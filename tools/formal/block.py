# SPDX-License-Identifier: BSD-3-Clause
"""What is proven about one block, and the faults that its proof must notice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

# Rows with the property file of another row, and other generics. Not a field of `Block`, because all
# fields are in the digests of all blocks.
SAME_FILE = {"frame_application_lists": "frame_application"}


@dataclass(frozen=True)
class Mutant:
    """A seeded fault: it replaces one text of one VHDL file. The text occurs there once."""

    file: str  # bare name of a file of gateware/
    old: str
    new: str


@dataclass(frozen=True)
class Block:
    """One property file, gateware/formal/<top>.vhd, and the questions for the solvers.

    z3 searches for a violation within `depth` clocks from power-up, ABC within `deep` clocks. Two methods go
    beyond that. With `induction`, z3 shows that so many good clocks are followed by another one. With `pdr`,
    ABC finds an invariant. Without either, the proof is bounded, and the page says so. Every cover must be
    reached within the clocks that are searched. So must the moment at which each part of each property counts
    (`cases`). A proof for ever may take up to `reach` clocks for that.

    A cover that lies deep may need a guide: inputs that are constants on the way to it (`guided`). If ABC
    shows the induction (`by_abc`), a mutant must make it fail, because the fault lies too deep for a search.

    A part may be left out if it has a proof of its own, or too much memory for a solver. Each (entity,
    instance) of `without` is removed, and each signal in `loose` loses its driver. An undriven signal has any
    value at any time. What holds without the part also holds with it. Inputs of the property file show
    signals of the design (`seen`). So it can assume about a loose signal what is proven elsewhere. Outputs of
    it drive signals of the design in place of their drivers (`given`). For these, another proof must show
    that both are equal.
    """

    name: str
    what: str
    depth: int
    mutants: tuple[Mutant, ...]
    deep: int = 0
    reach: int = 0
    induction: int | None = None
    by_abc: bool = False  # ABC shows the induction, because the model is too large for z3
    pdr: bool = False
    for_ever: tuple[str, ...] = ()  # too many for `pdr` at once, so they are proven one by one
    generics: Mapping[str, int | str | bool] = field(default_factory=dict)
    without: tuple[tuple[str, str], ...] = ()
    seen: Mapping[str, str] = field(default_factory=dict)  # port: signal
    loose: tuple[str, ...] = ()
    given: Mapping[str, str] = field(default_factory=dict)  # signal: output of the property file
    not_proven: str = ""  # what a reader may expect, but is not proven
    guided: Mapping[str, int | str] = field(
        default_factory=dict
    )  # inputs that stand still on the way to the covers
    quick: bool = False  # also proven in the short form, which is a test
    # each clock is an input; depths then count steps, and any clock may change in a step
    several_clocks: bool = False

    def __post_init__(self) -> None:
        if self.by_abc and self.induction is None:
            raise ValueError(f"{self.name}: ABC shows an induction, and there is none: no `by_abc`")
        if self.reach and self.is_bounded:
            raise ValueError(f"{self.name}: what a bounded proof does not search proves nothing: no `reach`")

    @property
    def top(self) -> str:
        """The entity of the property file."""
        return f"{SAME_FILE.get(self.name, self.name)}_formal"

    @property
    def searched(self) -> int:
        """How many clocks from power-up are searched for a violation."""
        return max(self.depth, self.deep)

    @property
    def is_bounded(self) -> bool:
        """Whether nothing is known about the clocks after those that are searched."""
        return self.induction is None and not self.pdr

    @property
    def reached(self) -> int:
        """The number of clocks within which every case and every cover must be reached."""
        return self.searched if self.is_bounded else max(self.reach, self.searched)
