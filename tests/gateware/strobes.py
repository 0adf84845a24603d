# SPDX-License-Identifier: BSD-3-Clause
"""Measure the base strobes of a core in a bench, and the time from each to the bus access of a publish."""

from __future__ import annotations

from bisect import bisect
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from unitylink.simulate import BoardConfiguration

CLOCK_FS = 2_000_000  # of replay_tb
STROBE = {  # of each engine
    "fast": "/replay_tb/core/core_bii/publishing/subscription_manager/strobe",
    "small": "/replay_tb/core/core_bii/small_side/framed_small/publishes/small_publishing/strobe",
}
PUBLISHED = 0x77  # the address of the first word of the publish that is watched


def ticks_of(path: Path) -> list[int]:
    """Return the clocks at which the base strobe rises, from the waves of one signal."""
    now, found = 0, []
    for line in path.read_text(encoding="ascii").splitlines():
        if line.startswith("#"):
            now = int(line[1:])
        elif line.startswith("1"):
            found.append(now // CLOCK_FS + 1)
    return found


class WithOptions:
    """A simulator that gets extra options in each run."""

    def __init__(self, ghdl: Any, options: tuple[str, ...]) -> None:
        self.ghdl, self.options = ghdl, options

    def run(self, bench: str, **generics: int | str | bool) -> str:
        return str(self.ghdl.run(bench, *self.options, **generics))


class Watch:
    """A player for the core that also sees its base strobes."""

    def __init__(self, rtl: Any, folder: Path, engine: str = "fast") -> None:
        self.rtl, self.waves = rtl, folder / "ticks.vcd"
        (folder / "ticks.opt").write_text(f"$ version 1.1\n{STROBE[engine]}\n", encoding="ascii")
        options = (f"--vcd={self.waves}", f"--read-wave-opt={folder / 'ticks.opt'}")
        rtl.ghdl = WithOptions(rtl.ghdl, options)

    def delays(
        self, configuration: BoardConfiguration, steps: Sequence[tuple[str, Any]], **generics: Any
    ) -> list[int]:
        """Return the clocks from each base strobe but the first to the first bus strobe at PUBLISHED."""
        self.rtl(configuration, [steps], **generics)
        ticks = ticks_of(self.waves)
        accesses = [at for kind, at, value in self.rtl.times if kind == "t" and value == PUBLISHED]
        first = [
            accesses[place] for tick in ticks[1:] if (place := bisect(accesses, tick - 1)) < len(accesses)
        ]
        return [at - tick for at, tick in zip(first, ticks[1:], strict=False)]
