# SPDX-License-Identifier: BSD-3-Clause
"""Build the bitstreams of the robots on docs/robots.md, and keep what they take: `make bitstreams`.

The page has a command for each robot and board. The record is gateware/bitstreams.json, and the table of the
page is made from it. With --changed, only those are built whose spec, board, pins or gateware have changed.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import re
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from unitylink.boards import Order, build_bitstream, load_board
from unitylink.boards.flow import prepare
from unitylink.gateware import gateware_sources
from unitylink.gateware.dependencies import needed_sources, plain_text

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "docs" / "robots.md"
RECORD = ROOT / "gateware" / "bitstreams.json"
FULL = 0.8  # a fuller chip has no room to spare
# These fill more, and docs/robots.md says so.
FULLER = {"diff_drive ice40-hx8k": 1.0}
_COMMAND = re.compile(r"^unitylink build (examples/(\w+)/\w+\.ul) --board ([\w:-]+)((?: --pin \S+)*)$", re.M)
_TABLE = re.compile(r"(<!-- `make bitstreams` writes this table -->\n\n).*?(?=\n\n[^|]|\n*\Z)", re.DOTALL)


@dataclass(frozen=True)
class Command:
    """A command of the page: a robot, its board, and where its ports go."""

    spec: str
    robot: str
    board: str
    pins: tuple[str, ...]

    @property
    def name(self) -> str:
        return f"{self.robot} {self.board}"

    def order(self, folder: Path) -> Order:
        """Return what is to be built in `folder`."""
        return Order(
            spec_file=str(ROOT / self.spec), folder=folder, board=load_board(self.board), pins=self.pins
        )


def commands(page: str) -> list[Command]:
    r"""Return the commands of a page.

    >>> [command.name for command in commands("unitylink build examples/a/a.ul --board b \\\n  --pin c=D1\n")]
    ['a b']
    """
    text = re.sub(r"\s*\\\n\s*", " ", page)
    return [
        Command(spec, robot, board, tuple(pins.split()[1::2]))
        for spec, robot, board, pins in _COMMAND.findall(text)
    ]


def inputs_digest(command: Command) -> str:
    """Return 16 hex digits over what belongs to the command alone: its pins, the spec and the board."""
    said = hashlib.sha256(repr((command.board, command.pins)).encode())
    board = command.board.partition(":")[0]
    for path in (ROOT / command.spec, ROOT / "boards" / board / "board.toml"):
        lines = (re.sub(r"(^|\s+)(//+|#)( .*)?$", "", line) for line in path.read_text("utf-8").splitlines())
        said.update("\n".join(line for line in lines if line.strip()).encode() + b"\0")
    return said.hexdigest()[:16]


def gateware_digest(command: Command) -> str:
    """Return 16 hex digits over the VHDL of the design. Comments and blanks do not count."""
    said = hashlib.sha256()
    with tempfile.TemporaryDirectory() as folder:
        prepare(command.order(Path(folder) / "design"))
        made = sorted(Path(folder).rglob("*.vhd"))
        text = " ".join(map(plain_text, made))
        units = set(re.findall(r"\bunitylink\.(\w+)", text))
        sources = {path for unit in units for path in needed_sources(unit, gateware_sources())}
        for path in (*sorted(sources), *made):
            said.update(plain_text(path).encode() + b"\0")
    return said.hexdigest()[:16]


def built(command: Command) -> dict[str, Any]:
    """Build a bitstream, and return its row of the record. Raises BoardError."""
    folder = ROOT / "build" / "bitstreams" / command.name.replace(" ", "-").replace(":", "-")
    report = build_bitstream(command.order(folder), lambda step: print(f"  {step}", flush=True))
    area = {one.what: (one.used, one.available) for one in report.area}
    return {
        "inputs": inputs_digest(command),
        "gateware": gateware_digest(command),
        "cells": area["logic cells"],
        "memories": area["block RAM"],
        "mhz": round(report.fmax_hz / 1e6, 1),
        "asked_mhz": round(report.clock_hz / 1e6, 3),
    }


def table(wanted: list[Command], record: dict[str, Any]) -> str:
    """Return the table of the page. It says which bitstreams have not been built yet."""
    lines = ["| robot | board | logic cells | block RAM | MHz, and asked |", "| -- | -- | -- | -- | -- |"]
    for command in wanted:
        told = "not built yet |  | "
        if row := record.get(command.name):
            cells, memories = ("{} of {}".format(*row[what]) for what in ("cells", "memories"))
            told = f"{cells} | {memories} | {row['mhz']}, {row['asked_mhz']:.4g}"
        lines.append(f"| `{command.robot}` | `{command.board}` | {told} |")
    return "\n".join(lines)


def with_table(page: str, record: dict[str, Any]) -> str:
    """Return the page with the table of a record. Raises ValueError if it has no place for one."""
    found, count = _TABLE.subn(lambda place: place.group(1) + table(commands(page), record), page)
    if count != 1:
        raise ValueError(f"{PAGE}: the table of `make bitstreams` belongs there once, not {count} times")
    return found


def selected(there: list[Command], names: list[str]) -> list[Command]:
    """Return the commands of the robots and of the boards among `names`. Without a robot they are all meant.

    >>> there = [Command("", robot, board, ()) for robot in "ab" for board in "xy"]
    >>> [command.name for command in selected(there, ["a", "y"])]
    ['a y']
    >>> [command.name for command in selected(there, ["y"])]
    ['a y', 'b y']
    """
    strange = set(names) - {command.robot for command in there} - {command.board for command in there}
    if strange:
        raise SystemExit(f"{', '.join(sorted(strange))}: no robot and no board of {PAGE.name}")
    robots, boards = ({command.robot for command in there}, {command.board for command in there})
    return [
        command
        for command in there
        if (command.robot in names or not robots & set(names))
        and (command.board in names or not boards & set(names))
    ]


def complaints(record: dict[str, Any]) -> list[str]:
    """Return what is wrong with a record: too slow, or too full."""
    found = []
    for name, row in record.items():
        if row["mhz"] < row["asked_mhz"]:
            found.append(f"{name}: {row['mhz']} MHz, and {row['asked_mhz']} are asked")
        for what in ("cells", "memories"):
            used, available = row[what]
            if used > FULLER.get(name, FULL) * available:
                found.append(f"{name}: {used} of {available} {what} leave no room to spare")
    return found


def main(arguments: list[str]) -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--changed", action="store_true")
    parser.add_argument("--only", nargs="+", default=[], metavar="NAME", help="robots and boards")
    wanted = parser.parse_args(arguments)
    known = json.loads(RECORD.read_text("utf-8")) if RECORD.exists() else {}
    record = {}
    there = commands(PAGE.read_text("utf-8"))
    for command in there:
        row = known.get(command.name)
        chosen = command in selected(there, wanted.only)
        if chosen and wanted.changed and row is not None:
            chosen = (row["inputs"], row["gateware"]) != (inputs_digest(command), gateware_digest(command))
        if chosen:
            print(command.name, flush=True)
            row = built(command)
        if row is not None:
            record[command.name] = row
            rest = {name: known[name] for name in known if name not in record}
            RECORD.write_text(json.dumps({**record, **rest}, indent=1) + "\n", encoding="utf-8")
    RECORD.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    PAGE.write_text(with_table(PAGE.read_text("utf-8"), record), encoding="utf-8")
    found = complaints(record)
    print(*found, sep="\n", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
