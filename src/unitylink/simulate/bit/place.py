# SPDX-License-Identifier: BSD-3-Clause
"""The bitstream that is run: built for a spec and kept in the cache, or one that a user has built."""

from __future__ import annotations

import base64
import hashlib
import json
import tempfile
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from unitylink import boards
from unitylink.boards import Board, Order, build_bitstream, read_report
from unitylink.boards.flow import Prepared, prepare
from unitylink.errors import BoardError
from unitylink.gateware import gateware_sources, run_tool

from ..rtl.cache import cached

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Placed:
    """A bitstream, and the report of its build (docs/build.md): board, baud rate, hash, pins, words."""

    bitstream: bytes
    report: Mapping[str, Any]


def placed(order: Order, say: Progress) -> Placed:
    """Return the bitstream that `unitylink build` makes of `order`. Only the first time it is built.

    `order.folder` is not used. Raises what `build_bitstream` raises, and BoardError if the bitstream could
    not be run.
    """
    check_runs(order.board)
    with tempfile.TemporaryDirectory(prefix="unitylink-bit-") as work:
        wanted = replace(order, folder=Path(work) / "build")
        design = prepare(wanted)

        def build(file: Path) -> None:
            say(f"placing {design.spec.name} on {order.board.name}, this once")
            report = build_bitstream(
                wanted, lambda text: say(f"placing {design.spec.name}, this once: {text}")
            )
            kept = {
                "report": asdict(report),
                "bitstream": base64.b64encode(Path(report.bitstream).read_bytes()).decode(),
            }
            file.write_text(json.dumps(kept), encoding="utf-8")

        file = cached(_key(wanted, design), build, say, kind="bit", suffix=".json")
    kept = json.loads(file.read_text(encoding="utf-8"))
    return Placed(base64.b64decode(kept["bitstream"]), kept["report"])


def placed_in(folder: Path) -> Placed:
    """Return the bitstream in a folder that `unitylink build` made. Raises BoardError."""
    report = read_report(folder)
    file = folder / Path(report["bitstream"]).name
    try:
        return Placed(file.read_bytes(), report)
    except OSError as error:
        raise BoardError(f"{file}: {error.strerror}; `unitylink build` makes it again") from error


def check_runs(board: Board) -> None:
    """Raise BoardError if no bitstream of `board` can be run."""
    if board.physical != "uart":
        raise BoardError(
            f"{board.name}: its link is {board.physical}, and a bitstream is run with a UART only; "
            "rtl: has the other physical layers"
        )


def _key(order: Order, design: Prepared) -> str:
    """Return a hash of everything that goes into the bitstream."""
    files = [*sorted((order.folder / "vhdl").glob("*")), *design.logic.sources, *gateware_sources()]
    files += [order.board.path, *sorted(Path(boards.__file__).parent.glob("*.py"))]
    given = replace(order, folder=Path(), spec_file="", logic=())
    parts = [repr(given), design.spec.hash, str((design.clock_hz, design.baud_hz))]
    parts += [f"{file.name}\n{file.read_text(encoding='utf-8')}" for file in dict.fromkeys(files)]
    for command in (["ghdl", "--version"], ["yosys", "-V"], [design.place_command[0], "--version"]):
        parts.append(run_tool(command, joined=True).out)
    return hashlib.sha256("\0".join(parts).encode()).hexdigest()[:32]
