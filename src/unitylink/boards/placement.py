# SPDX-License-Identifier: BSD-3-Clause
"""A mapped design is placed and routed by nextpnr, with one seed and placer after another."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

from unitylink.errors import BoardError, ToolError
from unitylink.gateware import run_tool
from unitylink.gateware.programs import Ended
from unitylink.interface.board_configuration import BoardConfiguration

from .families import FAMILIES, overflow
from .fit import too_large
from .manifest import CHIP_CLOCK_HZ, Board
from .report import Area

_NO_PLACEMENT = "Unable to find legal placement"  # also on a chip with room: another seed may
_LINES_SHOWN = 6


@dataclass(frozen=True)
class Placement:
    """A placed and routed design that meets its clock: the rates that nextpnr guarantees, and its area."""

    fmax_hz: int
    link_fmax_hz: int | None  # the highest rate of the clock that the link's chip gives
    seed: int
    placer: str  # of nextpnr
    area: tuple[Area, ...]


@dataclass(frozen=True)
class Placing:
    """What is placed: board.json and the constraints in `folder`, by `command`, for a clock.

    `command` calls nextpnr for the chip of `board` (Family.place_command). `seeds` are tried at most.
    """

    board: Board
    configuration: BoardConfiguration
    command: Sequence[str]
    folder: Path
    clock_hz: int
    seeds: int

    @property
    def log(self) -> Path:
        """The whole output of nextpnr."""
        return self.folder / "nextpnr.log"

    @property
    def timing(self) -> Path:
        """The clocks, their longest paths and the cells in use, as nextpnr reports them."""
        return self.folder / "timing.json"


def place(wanted: Placing, tell: Callable[[str], None]) -> Placement:
    """Place and route with one seed after another until all cells have a place and the clock is met.

    Each seed is tried with each placer of the family. A placer that fails is passed over, unless it is the
    last one. Raises BoardError if no placement meets the clock, and ToolError if nextpnr fails.
    """
    family = FAMILIES[wanted.board.family]
    clock_hz = wanted.clock_hz
    best = link_best = 0
    routed = False
    for seed, placer in product(range(1, wanted.seeds + 1), family.algorithms):
        once = f"seed {seed}, placer {placer}"
        tell(f"nextpnr places and routes, {once}")
        ended = _nextpnr(wanted, seed, placer)
        if _NO_PLACEMENT in ended.out and not overflow(ended.out):
            tell(f"{once} finds no place for all cells")
            continue
        if ended.code != 0:
            if overflow(ended.out) or placer == family.algorithms[-1]:
                raise _refused(wanted, ended.out)
            tell(f"{once} fails, and another placer is tried: {_errors(ended.out)[-1]}")
            continue
        routed = True
        timing = json.loads(wanted.timing.read_text(encoding="utf-8"))
        fmax_hz, link_fmax_hz = fmax(timing["fmax"], wanted.board.link_clock)
        if link_fmax_hz is not None and link_fmax_hz < CHIP_CLOCK_HZ:
            link_best = max(link_best, link_fmax_hz)
            tell(f"{once} reaches {link_fmax_hz / 1e6:.1f} MHz of the chip's {CHIP_CLOCK_HZ / 1e6:g} MHz")
            continue
        best = max(best, fmax_hz)
        if fmax_hz >= clock_hz:
            used = timing["utilization"]
            area = tuple(
                Area(what, used[cell]["used"], used[cell]["available"])
                for cell, what in family.area
                if cell in used
            )
            return Placement(fmax_hz, link_fmax_hz, seed, placer, area)
        tell(f"{once} reaches {fmax_hz / 1e6:.1f} of {clock_hz / 1e6:.6g} MHz")
    seeds = f"{wanted.seeds} seeds"
    if not routed:
        raise BoardError(
            f"nextpnr finds no place for all cells with {seeds}, although the chip has enough of "
            f"them: try more with --seeds, or a larger chip. Its whole output: {wanted.log}"
        )
    if not best:
        raise BoardError(
            f"the link is too slow for its chip's clock: {link_best / 1e6:.1f} MHz at best of {seeds}, "
            f"and {CHIP_CLOCK_HZ / 1e6:g} MHz are needed: try more with --seeds"
        )
    raise BoardError(
        f"the design is too slow for its clock: {best / 1e6:.1f} MHz at best of {seeds}, and "
        f"{clock_hz / 1e6:.6g} MHz are needed; --clock-hz {int(best // 1e6) * 1_000_000} would do, or try "
        f"more with --seeds. The path that is too long is in {wanted.timing}"
    )


def _nextpnr(wanted: Placing, seed: int, placer: str) -> Ended:
    """Run nextpnr once. Its whole output goes to `wanted.log`."""
    family = FAMILIES[wanted.board.family]
    option, ending = family.routed
    files = ["--json", "board.json", f"--{family.constraints}", f"board.{family.constraints}"]
    files += [option, f"board.{ending}", "--report", wanted.timing.name]
    options = ["--freq", f"{wanted.clock_hz / 1e6:.6f}", "--seed", str(seed), "--placer", placer]
    ended = run_tool([*wanted.command, *files, *options, "--timing-allow-fail"], wanted.folder, joined=True)
    wanted.log.write_text(ended.out, encoding="utf-8")
    return ended


def fmax(clocks: Mapping[str, Mapping[str, float]], link_clock: str | None) -> tuple[int, int | None]:
    """Return nextpnr's guaranteed rate of the design's clock.

    If a chip's pin gives a clock, also return the rate of that one.

    >>> fmax({"clock_": {"achieved": 50.0}, "$glbnet$FIFO_CLK$IN": {"achieved": 90.5}}, "FIFO_CLK")
    (50000000, 90500000)
    >>> fmax({"clock_": {"achieved": 50.0}}, None)
    (50000000, None)
    """
    best: dict[bool, int] = {}  # whether it is the link's clock -> rate
    for name, clock in clocks.items():
        of_link = link_clock is not None and link_clock in name.split("$")
        best[of_link] = min(best.get(of_link, sys.maxsize), int(clock["achieved"] * 1e6))
    if link_clock is not None and True not in best:
        raise ToolError(f"nextpnr reports no clock on {link_clock}, only of {', '.join(clocks) or 'none'}")
    return best.get(False, 0), best.get(True)


def _refused(wanted: Placing, said: str) -> BoardError | ToolError:
    """Explain in our words why nextpnr gave up."""
    if too_many := overflow(said):
        text = ", ".join(f"{used} {cell} and it has {there}" for cell, used, there in too_many)
        return too_large(wanted.board, wanted.configuration, f"it takes {text}.")
    return ToolError(f"nextpnr failed (its whole output: {wanted.log}):\n" + "\n".join(_errors(said)))


def _errors(said: str) -> list[str]:
    """Return the lines of nextpnr's output that name an error. Without one, return the last lines."""
    lines = said.strip().splitlines()
    return [line for line in lines if "ERROR" in line] or lines[-_LINES_SHOWN:] or ["it says nothing"]
