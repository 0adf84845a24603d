# SPDX-License-Identifier: BSD-3-Clause
"""Find the program that writes a bitstream to a board, and call it."""

from __future__ import annotations

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from unitylink.errors import BoardError, ToolError

from .manifest import Board, load_board
from .report import read_report

PACKAGES = {"iceprog": "fpga-icestorm", "openFPGALoader": "openfpgaloader"}
# The arguments of each program, for the chip's own memory, which is lost without power, and for the flash.
_VOLATILE = {"iceprog": ["-S"], "openFPGALoader": []}
_LASTING = {"iceprog": [], "openFPGALoader": ["--write-flash"]}


def flash_command(folder: Path, *, volatile: bool = False, program: str | None = None) -> list[str]:
    """Return the command that writes the bitstream of `unitylink build` in `folder`.

    It writes the flash, from which the chip starts from then on. With `volatile` it writes only the chip. It
    takes the first installed program of the board's manifest, unless `program` names one. Raises BoardError
    and ToolError.
    """
    report = read_report(folder)
    board = load_board(report["board"])
    bitstream = folder / Path(report["bitstream"]).name
    if not bitstream.is_file():
        raise BoardError(f"{bitstream} does not exist any more; `unitylink build` makes it again")
    name = _program(board, program)
    mode = (_VOLATILE if volatile else _LASTING)[name]
    return [str(shutil.which(name)), *board.flash[name], *mode, str(bitstream)]


def run_flash(command: Sequence[str]) -> None:
    """Run the command. Its output goes to the terminal. Raises ToolError if it fails."""
    done = subprocess.run(list(command), check=False)
    if done.returncode != 0:
        raise ToolError(
            f"{Path(command[0]).name} ended with {done.returncode}: is the board plugged in, and may you use "
            "it? `unitylink doctor` tells"
        )


def _program(board: Board, wanted: str | None) -> str:
    known = [name for name in board.flash if name in PACKAGES]
    if wanted is not None and wanted not in known:
        raise BoardError(f"{board.name}: {wanted} is not one of its programs: {', '.join(known)}")
    names = [wanted] if wanted else known
    for name in names:
        if shutil.which(name):
            return name
    packages = " or ".join(PACKAGES[name] for name in names)
    raise ToolError(f"{' or '.join(names)} is missing; on Debian or Ubuntu: sudo apt-get install {packages}")
