# SPDX-License-Identifier: BSD-3-Clause
"""Runs open tools on a design. The build script beside generated VHDL calls it.

python -m unitylink.gateware.build ice40 servo_top build vhdl/servo_*.vhd
"""

from __future__ import annotations

import re
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from unitylink.errors import ToolError

from .library import DesignGhdl
from .netlist import netlist
from .programs import map_cells
from .sources import gateware_sources, simulation_sources

# Checks that are for a simulation. A chip has none of them, and yosys does not read them.
_ASSERTION = re.compile(r"^  always @\*\n    if \(!\w+\)\n      \$fatal\(1, \"[^\"]*\"\);\n", re.MULTILINE)
_USAGE = "usage: python -m unitylink.gateware.build check|test|verilog|FAMILY TOP FOLDER FILE.vhd ..."


def build(target: str, top: str, folder: Path, sources: Sequence[Path]) -> list[Path]:
    """Do `target` for the entity `top`, with `sources` and the gateware. Return the files made in `folder`.

    "check" analyses everything and elaborates `top`. "test" runs it as a bench. "verilog" makes TOP.v. A
    family of yosys (ice40, ecp5, gowin, xilinx, ...) makes TOP.v and TOP.json, which its place-and-route
    reads. Raises ToolError.
    """
    if target in ("check", "test"):
        gateware = [*gateware_sources(), *simulation_sources()]
        with tempfile.TemporaryDirectory(prefix="unitylink-build-") as work:
            ghdl = DesignGhdl(Path(work), gateware, [path.resolve() for path in sources])
            if target == "check":
                ghdl.make(top)
            else:
                print(ghdl.run(top), end="")
        return []
    if not re.fullmatch(r"[a-z0-9]+", target):
        raise ToolError(f"{target!r} is neither check, test, verilog nor a family of yosys such as ice40")
    folder.mkdir(parents=True, exist_ok=True)
    verilog = folder / f"{top}.v"
    verilog.write_text(_ASSERTION.sub("", netlist(top, sources=sources)), encoding="utf-8")
    return [verilog] if target == "verilog" else [verilog, _mapped(target, top, verilog)]


def _mapped(family: str, top: str, verilog: Path) -> Path:
    made = verilog.with_suffix(".json")
    print(map_cells(family, top, [verilog.name], made.name, verilog.parent))
    return made


def main(arguments: Sequence[str]) -> int:
    """Run from the command line. Return the exit code."""
    least = 3
    if len(arguments) < least:
        print(_USAGE, file=sys.stderr)
        return 2
    target, top, folder, *files = arguments
    try:
        made = build(target, top, Path(folder), [Path(file) for file in files])
    except (ToolError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    for path in made:
        print(f"wrote {path}")
    if not made:
        print(f"{top}: no error")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
