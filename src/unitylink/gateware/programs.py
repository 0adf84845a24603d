# SPDX-License-Identifier: BSD-3-Clause
"""Finds and runs the programs that make a bitstream of a netlist, and reports their failures."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from unitylink.errors import ToolError

_SECONDS_MOST = 1800.0
_LINES_SHOWN = 8


def find_program(names: Sequence[str], remedy: str) -> str:
    """Return the path of the first of `names` that is beside this Python or on PATH.

    Raises ToolError, which says that it is missing and the `remedy`.
    """
    beside = str(Path(sys.executable).parent)
    for name in names:
        found = shutil.which(name, path=beside) or shutil.which(name)
        if found is not None:
            return found
    raise ToolError(f"{' or '.join(names)} is missing; {remedy}")


@dataclass(frozen=True)
class Ended:
    """How a program ended: its exit code and what it printed on stdout and stderr."""

    code: int
    out: str
    err: str


def run_tool(
    command: Sequence[str],
    folder: Path | None = None,
    *,
    called: str = "",
    joined: bool = False,
    timeout_s: float = _SECONDS_MOST,
) -> Ended:
    """Run a program in `folder` to its end.

    With `joined` stderr comes in stdout, at its place. `called` is what the message says for it. Raises
    ToolError when it hangs.
    """
    try:
        done = subprocess.run(
            list(command),
            cwd=folder,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT if joined else subprocess.PIPE,
            text=True,
            errors="replace",
            timeout=timeout_s,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        name = called or Path(command[0]).name
        raise ToolError(f"{name}: it did not end within {timeout_s:.0f} s") from error
    return Ended(done.returncode, done.stdout, done.stderr or "")


def map_cells(family: str, top: str, sources: Sequence[str], made: str, folder: Path) -> str:
    """Let yosys map Verilog on the cells of a family (ice40, ecp5, ...) and write JSON for nextpnr.

    `sources` and `made` are names in `folder`. Return how many cells of each kind, as yosys prints it.
    """
    yosys = find_program(["yosys"], "on Debian or Ubuntu: sudo apt-get install yosys")
    script = f"read_verilog {' '.join(sources)}; synth_{family} -top {top}; stat; write_json {made}"
    ended = run_tool([yosys, "-p", script], folder, joined=True)
    if ended.code != 0:
        lines = "\n".join(ended.out.strip().splitlines()[-_LINES_SHOWN:])
        raise ToolError(f"yosys synth_{family} of {top} failed:\n{lines}")
    return ended.out.rpartition("Printing statistics.")[2].split("\n\n\n")[0].strip()
