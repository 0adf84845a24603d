# SPDX-License-Identifier: BSD-3-Clause
"""GHDL, called on a work folder of its own."""

from __future__ import annotations

import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Union

from unitylink.errors import ToolError

Generic = Union[int, str, bool]

_SECONDS_MOST = 600.0  # of one call; the largest design takes a few seconds
_LINES_SHOWN = 30
# GHDL warns of these and then makes a netlist that does something else.
_WRONG_LOGIC = re.compile(r"warning:.*(meta-?value|latch)", re.IGNORECASE)


class Ghdl:
    """One library of VHDL-2008 sources, analysed in the folder `work`.

        ghdl = Ghdl(work, gateware_sources())
        verilog = ghdl.synthesise("fifo_slave", "verilog", {"depth": 64})

    Raises ToolError if GHDL is missing or refuses a source, with GHDL's own message.
    """

    def __init__(self, work: Path, sources: Sequence[Path]) -> None:
        executable = shutil.which("ghdl")
        if executable is None:
            raise ToolError("ghdl is missing; on Debian or Ubuntu: sudo apt-get install ghdl")
        self._executable = executable
        self._work = work
        self._made: set[str] = set()
        for source in sources:
            if not source.is_file():
                raise ToolError(f"{source}: there is no such VHDL file")
        self._call("-i", "--std=08", *map(str, sources))

    def make(self, top: str) -> None:
        """Analyse the entity `top` and whatever it needs, in the right order."""
        if top not in self._made:
            self._call("-m", "--std=08", "-Wno-hide", top)
            self._made.add(top)

    def synthesise(
        self,
        top: str,
        language: str,
        generics: Mapping[str, Generic] | None = None,
        *,
        assertions: bool = True,
    ) -> str:
        """Return the netlist of `top` as GHDL prints it in `language` ("verilog" or "vhdl")."""
        self.make(top)
        settings = [f"-g{name}={_text(value)}" for name, value in (generics or {}).items()]
        settings += [] if assertions else ["--no-formal"]
        printed, said = self._call("--synth", "--std=08", f"--out={language}", *settings, top)
        if wrong := _WRONG_LOGIC.search(said):
            raise ToolError(
                f"ghdl --synth {top}: {wrong.group()}: the netlist would not do what the source does"
            )
        return printed

    def run(self, bench: str, **generics: Generic) -> str:
        """Run a self-checking bench to its end and return its output. Raise ToolError if it does not pass."""
        self.make(bench)
        settings = [f"-g{name}={_text(value)}" for name, value in generics.items()]
        checks = ["--assert-level=error", "--ieee-asserts=disable-at-0"]
        output = "".join(self._call("-r", "--std=08", bench, *settings, *checks))
        if f"{bench}: passed" not in output:
            raise ToolError(f"{bench} stopped before its end:\n{output}")
        return output

    def _call(self, *arguments: str) -> tuple[str, str]:
        command = [self._executable, *arguments]
        first = next((argument for argument in arguments if argument[0] != "-"), "")
        shown = f"ghdl {arguments[0]} {first}"
        try:  # not run_tool(): this file's code is in the digests of the proofs, which would all be stale
            done = subprocess.run(
                command, cwd=self._work, capture_output=True, text=True, timeout=_SECONDS_MOST, check=False
            )
        except subprocess.TimeoutExpired as error:
            raise ToolError(f"{shown}: no end after {_SECONDS_MOST:.0f} s") from error
        if done.returncode != 0:
            lines = (done.stderr + done.stdout).strip().splitlines()
            raise ToolError(f"{shown} ended with {done.returncode}:\n" + "\n".join(lines[:_LINES_SHOWN]))
        return done.stdout, done.stderr


def _text(value: Generic) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)
